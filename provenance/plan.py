"""What the workflow would do today: every step with its files, parameters and code.

Snakemake makes the plan, so it has all that a record should have, from the present configuration.
"""

from __future__ import annotations

import contextlib
import io
import json
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from provenance.record import RECORD_OUTPUTS, inputs_of
from tusqh.errors import ConfigError

_REMEDY = "run the same with snakemake instead of tusqh verify, which says more"


@dataclass(frozen=True)
class Step:
    """One job of the workflow as it would run today.

    Parameters
    ----------
    key
        Its name among all: ``chesapeake/mesh``, ``tables``; where its record is.
    rule, model
        The rule, and the model it is run for, if any.
    parameters, code
        As its record would have them.
    inputs, outputs
        Names of files, sorted; the records are not among the outputs.
    record, record_how
        Where its records are.
    """

    key: str
    rule: str
    model: str | None
    parameters: dict[str, Any]
    code: dict[str, str]
    inputs: list[str]
    outputs: list[str]
    record: Path
    record_how: Path


@dataclass(frozen=True)
class Plan:
    """All steps of the workflow as it would run today, in the order they depend on each other.

    Parameters
    ----------
    steps
        By key.
    maker
        The step that makes each file.
    command
        The command that runs the workflow so.
    base
        The checkout.
    snakefile
        The workflow.
    config_files, given_config_files
        The configuration files that were read, and those among them that were asked for.
    """

    steps: dict[str, Step]
    maker: dict[str, Step]
    command: str
    base: Path
    snakefile: Path
    config_files: list[Path]
    given_config_files: list[Path]

    @cached_property
    def recorder(self) -> dict[str, Step]:
        """The step that each record is of; some steps read the records of others."""
        return {str(step.record): step for step in self.steps.values()}

    def rerun(self, file: str) -> str:
        """Return the command that makes a file again, and then whatever depends on it."""
        return f"{self.command} --forcerun {shlex.quote(file)}"

    def remake(self, *files: str) -> str:
        """Return the command that makes some files again, whatever Snakemake thinks of them."""
        return f"{self.command} --force -- {shlex.join(files)}"


def make_plan(snakefile: Path, config_files: Sequence[Path] = ()) -> Plan:
    """Return what the workflow would do today in the present folder.

    Raises
    ------
    ConfigError
        There is no workflow, or it cannot be planned: a wrong configuration, a missing source.
    """
    if not snakefile.is_file():
        raise ConfigError(
            "there is no workflow here",
            where=str(snakefile),
            expected="a Snakefile",
            remedy="run the command in the folder that has it, or name it with --snakefile",
        )
    workflow = _load(snakefile, config_files)
    steps = {}
    for job in workflow.dag.toposorted():
        for step in sorted((_step(j) for j in job if j.rule.script), key=lambda s: s.key):
            steps[step.key] = step
    command = "snakemake --cores 2"
    if snakefile != Path("Snakefile"):
        command += f" --snakefile {shlex.quote(str(snakefile))}"
    if config_files:
        command += f" --configfile {shlex.join(map(str, config_files))}"
    return Plan(
        steps=steps,
        maker={path: step for step in steps.values() for path in step.outputs},
        command=command,
        base=Path(workflow.basedir),
        snakefile=snakefile,
        config_files=[Path(path) for path in workflow.configfiles],
        given_config_files=list(config_files),
    )


def _load(snakefile: Path, config_files: Sequence[Path]) -> Any:
    """Return Snakemake's workflow with its graph of jobs."""
    from snakemake.api import SnakemakeApi
    from snakemake.exceptions import WorkflowError
    from snakemake.settings.types import (
        ConfigSettings,
        DAGSettings,
        OutputSettings,
        Quietness,
        ResourceSettings,
    )

    output = OutputSettings(quiet={Quietness.ALL})
    try:
        with contextlib.redirect_stdout(io.StringIO()), SnakemakeApi(output) as api:
            workflow = api.workflow(
                resource_settings=ResourceSettings(cores=1),
                config_settings=ConfigSettings(configfiles=list(config_files)),
                snakefile=snakefile,
            )
            # The call builds the graph of jobs; what it prints is of no interest.
            workflow.dag(DAGSettings()).printrulegraph()
            return workflow._workflow
    except (WorkflowError, OSError, SyntaxError, ValueError, yaml.YAMLError) as reason:
        raise ConfigError(
            f"the workflow cannot be planned: {reason}",
            where=str(snakefile),
            expected="a configuration that snakemake accepts, and its source files",
            remedy=_REMEDY,
        ) from reason


def _step(job: Any) -> Step:
    # What a record holds has been through JSON: lists for tuples, plain numbers.
    parameters = json.loads(json.dumps(dict(job.params.items())))
    code = parameters.pop("code")
    outputs = {name: str(getattr(job.output, name)) for name in RECORD_OUTPUTS}
    record = Path(outputs["record"])
    model = job.wildcards_dict.get("model")
    return Step(
        key=record.stem if model is None else f"{model}/{record.stem}",
        rule=job.rule.name,
        model=model,
        parameters=parameters,
        code=code,
        inputs=inputs_of(map(str, job.input), parameters),
        outputs=sorted({str(path) for path in job.output} - set(outputs.values())),
        record=record,
        record_how=Path(outputs["record_how"]),
    )
