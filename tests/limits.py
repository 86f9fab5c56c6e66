"""Sizes of modules and functions: `python -m tests.limits` lists those beyond the limits."""

import ast
import sys
from pathlib import Path

FOLDERS = ("tusqh", "studies", "provenance", "workflow/scripts")
MODULE_LINES, FUNCTION_LINES, PARAMETERS = 350, 60, 8


def is_command(path, node):
    """Return whether a function is a command of the command line."""
    return path.parent.name in {"cli", "commands"} and node.name == path.stem


def may_have_many_parameters(path, node):
    """Return whether a function is the public call, a command, or compiled by numba."""
    decorators = [ast.unparse(d) for d in node.decorator_list]
    is_compiled = any("jit" in d or "compiled" in d for d in decorators)
    is_public_call = path.as_posix().endswith("pipeline/mesh.py") and node.name == "mesh"
    return is_compiled or is_public_call or is_command(path, node)


def count_lines(path, node):
    """Return the lines of a function without its docstring; of a long signature, only the body."""
    body = node.body
    n_docstring = 0
    if ast.get_docstring(node) is not None:
        n_docstring = body[0].end_lineno - body[0].lineno + 1
        body = body[1:]
    if may_have_many_parameters(path, node):
        return node.end_lineno - body[0].lineno + 1 if body else 0
    return node.end_lineno - node.lineno + 1 - n_docstring


def count_parameters(node):
    """Return the number of parameters of a function, `self` and `cls` excluded."""
    arguments = node.args
    named = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    return sum(a.arg not in {"self", "cls"} for a in named)


def find_beyond(root):
    """Return the sorted excesses over the limits as pairs (place, what was found)."""
    found = []
    for path in sorted(p for folder in FOLDERS for p in (root / folder).rglob("*.py")):
        place, text = path.relative_to(root).as_posix(), path.read_text()
        if (n := text.count("\n")) > MODULE_LINES:
            found.append((place, f"{n} lines"))
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            if (n := count_lines(path, node)) > FUNCTION_LINES:
                found.append((f"{place}::{node.name}", f"{n} lines"))
            n = count_parameters(node)
            if n > PARAMETERS and not may_have_many_parameters(path, node):
                found.append((f"{place}::{node.name}", f"{n} parameters"))
    return found


if __name__ == "__main__":
    beyond = find_beyond(Path(__file__).parents[1])
    print("\n".join(f"{place}: {what}" for place, what in beyond))
    sys.exit(bool(beyond))
