"""The typed model of the settings: the only place for their names, types, defaults and meanings.

A section of the settings is a frozen dataclass: `tusqh.settings.grid.Grid`,
`tusqh.settings.sampling.Sampling`, `tusqh.settings.policy.Policy`, `tusqh.settings.goal.Goal`,
`tusqh.settings.simulation.Simulation`.  `tusqh.settings.model` combines them.  The JSON schema, the
tables of ``config/README.md``, the options of the command line and the command in the explorer are
generated from the fields; ``python -m tusqh.settings`` regenerates the files.
"""
