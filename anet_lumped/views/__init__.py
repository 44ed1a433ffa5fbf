"""A run to be looked at: files for ParaView, a page for a browser, a film. Runs are read as they are; no run is made here."""
