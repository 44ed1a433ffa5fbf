"""Results as a person sees them: tables, figures, the report."""
