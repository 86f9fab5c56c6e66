# Every step with a script has, in addition to the contents of its rule: a log, two outputs that record
# how it ran, the list of its software, which documents it (see README), and a fingerprint of its
# code, so that Snakemake reruns the step when the code changes.
# This file comes last, when all rules are known.
STEPS = [r for r in workflow.modifier.rules if r.script and Path(r.snakefile).is_relative_to(BASE)]
CODE_OF_STEP = {step: f"workflow/scripts/{Path(step.script).name}" for step in STEPS}
LISTS_OF_CODE = Path("results/provenance/code")
FINGERPRINTS = code_fingerprints(
    [*CODE_OF_STEP.values(), *[f"tusqh/readers/{form.module}.py" for form in FORMATS]],
    base=BASE,
    store=BASE / "provenance/__pycache__/fingerprints.json",
)

for step, code_file in CODE_OF_STEP.items():
    record, log_file = record_of(step)
    step.set_output(record=f"{record}.json", record_how=f"{record}.how.json")
    step.set_params(code=FINGERPRINTS[code_file])
    step.log_modifier = step.output_modifier
    step.set_log(log_file)
    step.conda_env = os.fspath(BASE / "environment.yml")

hint_at_models(sys.argv[1:])

# Where this is the main workflow, a program of its own starts the steps, see ../steps.
if os.name == "posix" and Path(workflow.main_snakefile).resolve().is_relative_to(BASE):
    shell.prefix(f"set -euo pipefail; {START_STEP} ")


onstart:
    # Snakemake looks for jobs a second after each time that it looked, once more for each job that has
    # ended, so that a run with many jobs spends minutes on it. On this machine, no limit is needed.
    if workflow.local_exec:
        workflow.scheduler.job_rate_limiter = None
    write_bytecode(*[BASE / package for package in ("tusqh", "provenance", "studies")])
    if not is_compiled():
        logger.info("compiling functions, which only the first run after an installation does (a minute)")
        compile_functions()
    for code_file in sorted(set(CODE_OF_STEP.values())):
        if not (LISTS_OF_CODE / f"{FINGERPRINTS[code_file]['sha256']}.json").exists():
            list_code(code_file, base=BASE, folder=LISTS_OF_CODE)
    if many_steps_here():
        serve_steps()
