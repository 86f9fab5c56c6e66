"""Check the docstrings of public names: `python -m tests.docstrings tusqh/grid/background.py ...`.

numpydoc compares *Parameters* with the signature.  Two house rules are added: a docstring whose
first line states what is returned needs *Returns* only for a tuple, and a function that itself
raises an error of tusqh has *Raises*.
"""

import ast
import sys
from pathlib import Path

from numpydoc.docscrape import NumpyDocString
from numpydoc.hooks.validate_docstrings import DocstringVisitor

CHECKS = {"PR01", "PR02", "PR03", "PR07", "RT01", "RT03"}
CONFIG = {"checks": CHECKS, "exclude": None, "exclude_files": None, "overrides": {}}


class PublicDocstrings(DocstringVisitor):
    """Run numpydoc's checks, except on private and nested names."""

    def is_command(self, node):
        """Return whether a function is a command; its docstring is the text of ``--help``."""
        path = Path(self.filepath)
        return path.parent.name == "cli" and getattr(node, "name", "") == path.stem

    def _ignore_issue(self, node, check):
        if is_hidden(self.stack) or self.is_command(node):
            return True
        # numpydoc does not see the fields of a dataclass.
        if isinstance(node, ast.ClassDef) and check in {"PR01", "PR02"}:
            return True
        # The docstring of a command is its help; its options are documented separately.
        if check == "PR01" and is_command(Path(self.filepath), node):
            return True
        if check == "RT01" and says_what_it_returns(node):
            return True
        return super()._ignore_issue(node, check)


def is_command(path, node):
    """Return whether a function is a command of the command line."""
    is_function = isinstance(node, ast.FunctionDef)
    return is_function and path.parent.name in {"cli", "commands"} and node.name == path.stem


def is_hidden(stack):
    """Return whether a node is private, in something private, or inside a function."""
    inside_function = any(isinstance(n, ast.FunctionDef) for n in stack[:-1])
    return inside_function or any(getattr(n, "name", "").startswith("_") for n in stack)


def says_what_it_returns(node):
    """Return whether the first line of a docstring is enough to describe the result."""
    summary = (ast.get_docstring(node) or "").split(maxsplit=1)[:1]
    returns_tuple = ast.unparse(node.returns or ast.Constant(None)).startswith("tuple")
    is_property = any("property" in ast.unparse(d) for d in node.decorator_list)
    return is_property or (summary in (["Return"], ["Whether"], ["Yield"]) and not returns_tuple)


def parse(path):
    """Return the syntax tree of a file, with a heading before doctests that have none."""
    tree = ast.parse(Path(path).read_text(), str(path))
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node):
            text = ast.get_docstring(node)
            if "\nExamples\n---" not in text:
                text = text.replace("\n\n>>> ", "\n\nExamples\n--------\n>>> ", 1)
            node.body[0].value.value = text
    return tree


def without_raises(path):
    """Return the public functions that raise an error without a section *Raises*."""
    faults = []

    def visit(node, stack):
        stack = [*stack, node]
        is_checked = not is_hidden(stack) and not is_command(Path(path), node)
        if isinstance(node, ast.FunctionDef) and is_checked:
            raised = {
                n.exc.func.id
                for n in ast.walk(node)
                if isinstance(n, ast.Raise)
                and isinstance(n.exc, ast.Call)
                and isinstance(n.exc.func, ast.Name)
                and n.exc.func.id.endswith("Error")
            }
            sections = NumpyDocString(ast.get_docstring(node) or "")
            if raised and not sections["Raises"]:
                named = ", ".join(sorted(raised))
                faults.append(f"{path}:{node.lineno}: {node.name} raises {named}, not documented")
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.ClassDef | ast.FunctionDef):
                visit(child, stack)

    visit(parse(path), [])
    return faults


def find_faults(path):
    """Return a line for every fault in the public docstrings of a file."""
    visitor = PublicDocstrings(str(path), CONFIG)
    visitor.visit(parse(path))
    found = [f"{line}: {name}: {code} {text}" for line, name, code, text in visitor.findings]
    return found + without_raises(path)


if __name__ == "__main__":
    lines = [line for path in sys.argv[1:] for line in find_faults(path)]
    print("\n".join(lines))
    sys.exit(bool(lines))
