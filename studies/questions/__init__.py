"""The studies, one question each: a file, or a folder where the words or figures are long.

`studies.study` says what a study provides, and lists them.
"""
