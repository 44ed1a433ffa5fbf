"""The application: the command line, sweeps, studies and the report.

`command_line` is the program, with the commands around sweeps in `sweep_commands`. `sweeping` runs rows in parallel; `shown` turns
results into tables, figures and pages; `study` says what a study is and runs one, `questions` has them, `report` runs all.
`accuracy_cost`, `catalogue`, `peers` and `thesis_cable` are what several studies are made of.
"""
