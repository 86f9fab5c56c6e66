"""The plan: the steps that the workflow would run today, with their files, parameters and code.

Snakemake makes the plan from the current configuration.
"""

from __future__ import annotations

import contextlib
import io
import json
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import metadata
from pathlib import Path
from typing import Any

import yaml

from provenance.equality import EqualityRules
from provenance.record import RECORD_OUTPUTS, inputs_of
from tusqh.errors import ConfigError

#: The classes of equality of results, in the checkout.
EQUALITY = Path("workflow/equality.yaml")

_REMEDY = "run snakemake with the same options, which explains more"
#: The versions of Snakemake whose graph of jobs `_load` can read.
_SNAKEMAKE = "9."


@dataclass(frozen=True)
class Step:
    """One job of the workflow as it would run today.

    Parameters
    ----------
    key
        Unique name of the step, which is also the path of its record, such as ``chesapeake/mesh``.
    rule, model
        The rule, and the model, if there is one.
    parameters, code
        The parameters and the code as the record would state them.
    inputs, outputs
        Sorted names of files; the outputs do not include the records.
    record, record_how
        Paths of the records of the step.
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
    """All steps of the workflow as it would run today, in the order of their dependencies.

    Parameters
    ----------
    steps
        The steps by key.
    maker
        The step that makes each file.
    command
        The command that runs this workflow.
    base
        The checkout.
    snakefile
        The workflow.
    config_files, given_config_files
        The configuration files that were read, and those of them that an option names.
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
        """The step that writes each record, since some steps read the records of others."""
        return {str(step.record): step for step in self.steps.values()}

    @cached_property
    def equality(self) -> EqualityRules:
        """The class of equality of each output, from `EQUALITY` in the checkout."""
        return EqualityRules.from_file(self.base / EQUALITY)

    def rerun(self, file: str) -> str:
        """Return the command that makes a file again, and everything that depends on it.

        Parameters
        ----------
        file
            A file that a step writes.
        """
        return f"{self.command} --forcerun {shlex.quote(file)}"

    def remake(self, *files: str) -> str:
        """Return the command that makes files again even if Snakemake considers them current.

        Parameters
        ----------
        *files
            Files that steps write.
        """
        return f"{self.command} --force -- {shlex.join(files)}"


def make_plan(snakefile: Path, config_files: Sequence[Path] = ()) -> Plan:
    """Return the steps that the workflow would run today in the current folder.

    Parameters
    ----------
    snakefile
        The workflow.
    config_files
        Configuration files, as for ``snakemake --configfile``.

    Raises
    ------
    ConfigError
        There is no workflow, or it cannot be planned because of a wrong configuration, a missing
        source, or an unsupported version of Snakemake.
    """
    if not snakefile.is_file():
        raise ConfigError(
            "there is no workflow here",
            where=str(snakefile),
            expected="a Snakefile",
            remedy="run the command in the folder of the Snakefile, or use --snakefile",
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
    """Return Snakemake's workflow with its graph of jobs.

    Snakemake has no public access to the jobs of a graph, so this function, and no other, reads a
    private attribute, and only for the versions `_SNAKEMAKE`.
    """
    _require_snakemake()
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
            # This call builds the graph of jobs; its output is discarded.
            workflow.dag(DAGSettings()).printrulegraph()
            return workflow._workflow
    except (WorkflowError, OSError, SyntaxError, ValueError, yaml.YAMLError) as reason:
        raise ConfigError(
            f"the workflow cannot be planned: {reason}",
            where=str(snakefile),
            expected="a configuration that snakemake accepts, and its source files",
            remedy=_REMEDY,
        ) from reason


def _require_snakemake() -> None:
    """Raise an error unless `_load` can read the graph of this version of Snakemake."""
    version = metadata.version("snakemake")
    if not version.startswith(_SNAKEMAKE):
        raise ConfigError(
            f"version {version}",
            where="snakemake",
            expected=f"version {_SNAKEMAKE}*, whose graph of jobs tusqh can read",
            remedy="pip install -r requirements.lock",
        )


def _step(job: Any) -> Step:
    # Records are JSON, so parameters are compared as JSON: lists for tuples, plain numbers.
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
