"""Results as a person sees them: tables on the screen, sentences, figures, the report's page, and progress.

No file here runs a study or a sweep.
"""
