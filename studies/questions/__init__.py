"""The studies, one question a file; `studies.study` says what a study provides and runs it."""
