"""Run the command line as ``python -m tusqh``."""

from tusqh.cli.app import main

main()
