"""The typed model of the settings: one home for each name, type, default, range, unit and sentence.

A section of the settings is a frozen dataclass: `tusqh.settings.grid.Grid`,
`tusqh.settings.sampling.Sampling`, `tusqh.settings.policy.Policy`, `tusqh.settings.goal.Goal`,
`tusqh.settings.simulation.Simulation`.  `tusqh.settings.model` puts them together.  The JSON
schema, the tables of ``config/README.md``, the options of the command line and the command that
the explorer shows are made from the fields; ``python -m tusqh.settings`` writes the files again.
"""
