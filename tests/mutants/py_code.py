"""Mutants of the Python runtime, all of them in one set of modules; the twin of c_code.py.

The sources are changed on their way to the interpreter: `load()` puts modules in place of the original ones, in which
each mutant sleeps until `choose()` wakes it.
"""

from __future__ import annotations

import ast
import importlib.abc
import importlib.util
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType

from tests.mutants.mutant import Catalogue

PACKAGE = "odsmith_runtime.device"

_LOOSER: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.Gt: ast.GtE,
    ast.LtE: ast.Lt,
    ast.GtE: ast.Gt,
}
_TURNED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}

_REMOVABLE = (ast.Expr, ast.Assign, ast.AugAssign, ast.AnnAssign, ast.Delete, ast.Continue, ast.Break)

HELPERS = '''
"""What changed modules ask: whether a mutant is awake, and what a condition is then; and which mutants were passed."""
awake = 0
passed = set()
def is_awake(number):
    if awake:
        return awake == number
    passed.add(number)
    return False
def test(turned, never, condition):
    if awake:
        return not condition if awake == turned else False if awake == never else condition
    passed.add(turned)
    passed.add(never)
    return condition
def turn(number, condition):
    return not condition if is_awake(number) else condition
def operand(number, instead, value):
    return instead if is_awake(number) else value
def code(number, value):
    return next(other for other in type(value) if other is not value) if is_awake(number) else value
'''


def changed(path: Path, catalogue: Catalogue) -> ast.Module:
    """A module with all its mutants in it, which asks `_mutant` what HELPERS define."""
    return _Changer(path, catalogue).change()


class _Changer(ast.NodeTransformer):
    """Changes the functions of one file."""

    def __init__(self, path: Path, catalogue: Catalogue) -> None:
        self._text = path.read_text()
        self._lines = [line.encode() for line in self._text.splitlines(keepends=True)]
        self._file = path.name
        self._catalogue = catalogue
        self._scopes: list[str] = []
        self._is_function = False

    def change(self) -> ast.Module:
        module = ast.parse(self._text)
        self.visit(module)
        return ast.fix_missing_locations(module)

    def _source(self, node: ast.expr | ast.stmt) -> str:
        """Its text; `ast.get_source_segment` takes a hundred times as long."""
        end = node.end_lineno or node.lineno
        lines = self._lines[node.lineno - 1 : end]
        lines[-1] = lines[-1][: node.end_col_offset]
        lines[0] = lines[0][node.col_offset :]
        return b"".join(lines).decode()

    def _add(self, kind: str, node: ast.expr | ast.stmt, how: str = "") -> ast.expr:
        text = f"{self._source(node)}{' ' if how else ''}{how}"
        where = f"{self._file}:{'.'.join(self._scopes)}"
        return ast.Constant(self._catalogue.add(f"Python: {kind}", where, text))

    # ---- where mutants may be ----------------------------------------------------------------------------------------

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        self._scopes.append(node.name)
        node.body = self._statements(node.body)
        self._scopes.pop()
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        self._scopes.append(node.name)
        outer, self._is_function = self._is_function, True
        first = 1 if ast.get_docstring(node) is not None else 0
        node.body = [*node.body[:first], *self._statements(node.body[first:])]
        self._is_function = outer
        self._scopes.pop()
        return node

    def _statements(self, nodes: Sequence[ast.stmt]) -> list[ast.stmt]:
        return [self.visit(node) for node in nodes]  # type: ignore[misc]

    def visit(self, node: ast.AST) -> ast.AST:
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) or self._is_function:
            changed: ast.AST = super().visit(node)
            return self._removable(node, changed)
        return node

    def visit_match_case(self, node: ast.match_case) -> ast.AST:
        node.body = self._statements(node.body)
        if node.guard is not None:
            node.guard = self.visit(node.guard)  # type: ignore[assignment]
        return node

    # ---- mutants -----------------------------------------------------------------------------------------------------

    def _removable(self, node: ast.AST, changed: ast.AST) -> ast.AST:
        if not isinstance(node, _REMOVABLE) or (isinstance(node, ast.AnnAssign) and node.value is None):
            return changed
        test = ast.UnaryOp(ast.Not(), _call("is_awake", self._add("statement removed", node)))
        return ast.If(test, [changed], [])  # type: ignore[list-item]

    def visit_If(self, node: ast.If) -> ast.AST:
        turned, never = self._add("if turned", node.test), self._add("if removed", node.test)
        node.test = _call("test", turned, never, self._condition(node.test))
        node.body = self._statements(node.body)
        node.orelse = self._statements(node.orelse)
        return node

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        node.test = _call("turn", self._add("condition turned", node.test), self._condition(node.test))
        node.body = self.visit(node.body)  # type: ignore[assignment]
        node.orelse = self.visit(node.orelse)  # type: ignore[assignment]
        return node

    def visit_comprehension(self, node: ast.comprehension) -> ast.AST:
        node.iter = self.visit(node.iter)  # type: ignore[assignment]
        node.ifs = [_call("turn", self._add("condition turned", part), self._condition(part)) for part in node.ifs]
        return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        is_and = isinstance(node.op, ast.And)
        kind = "check removed" if is_and else "alternative removed"
        node.values = [
            _call(
                "operand",
                self._add(kind, node, f"without {self._source(part)}"),
                ast.Constant(is_and),
                self.visit(part),
            )
            for part in node.values
        ]
        return node

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        return self._comparison(node, can_turn=True)

    def _condition(self, node: ast.expr) -> ast.AST:
        """A condition that is turned round as a whole: a comparison need not be again."""
        return self._comparison(node, can_turn=False) if isinstance(node, ast.Compare) else self.visit(node)

    def _comparison(self, node: ast.Compare, *, can_turn: bool) -> ast.AST:
        node.left = self.visit(node.left)  # type: ignore[assignment]
        node.comparators = [self.visit(part) for part in node.comparators]  # type: ignore[misc]
        result: ast.expr = node
        for at, op in enumerate(node.ops):
            kind = "limit moved" if type(op) in _LOOSER else "comparison turned"
            other = _LOOSER.get(type(op)) or _TURNED[type(op)]
            if type(op) in _LOOSER or can_turn:
                ops = [*node.ops[:at], other(), *node.ops[at + 1 :]]
                changed = ast.Compare(node.left, ops, node.comparators)
                is_awake = _call("is_awake", self._add(kind, node, f"as {other.__name__}"))
                result = ast.IfExp(is_awake, changed, result)
        return result

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if isinstance(node.value, ast.Name) and node.value.id == "AbortCode":
            return _call("code", self._add("another abort code", node), node)
        return self.generic_visit(node)


def _call(name: str, *arguments: ast.AST) -> ast.expr:
    return ast.Call(ast.Attribute(ast.Name("_mutant", ast.Load()), name, ast.Load()), list(arguments), [])  # type: ignore[arg-type]


# ---- in place of the original modules --------------------------------------------------------------------------------


class _Loader(importlib.abc.InspectLoader):
    def __init__(self, tree: ast.Module, path: str, helpers: ModuleType) -> None:
        self._tree = tree
        self._path = path
        self._helpers = helpers

    def get_source(self, fullname: str) -> str:
        return ast.unparse(self._tree)

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__["_mutant"] = self._helpers
        exec(compile(self._tree, self._path, "exec"), module.__dict__)


class _Finder(importlib.abc.MetaPathFinder):
    def __init__(self, trees: dict[str, tuple[ast.Module, str]], helpers: ModuleType) -> None:
        self._trees = trees
        self._helpers = helpers

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if fullname not in self._trees:
            return None
        tree, origin = self._trees[fullname]
        return importlib.util.spec_from_loader(fullname, _Loader(tree, origin, self._helpers), origin=origin)


class ChangedRuntime:
    """The Python runtime with all mutants in it, none of them awake."""

    def __init__(self, sources: Sequence[Path]) -> None:
        """Changes the sources; `load` has to be called before a module of the runtime is imported."""
        self.catalogue = Catalogue()
        self._helpers = ModuleType("_mutant")
        exec(HELPERS, self._helpers.__dict__)
        self._trees = {
            f"{PACKAGE}.{path.stem}": (changed(path, self.catalogue), str(path))
            for path in sources
            if path.stem != "__init__"
        }

    def load(self) -> None:
        """From now on imports of the runtime's modules find these. Raises RuntimeError where it is too late."""
        late = [name for name in self._trees if name in sys.modules]
        if late:
            raise RuntimeError(f"already imported: {late[0]}")
        sys.meta_path.insert(0, _Finder(self._trees, self._helpers))

    def wake(self, number: int) -> None:
        self._helpers.__dict__["awake"] = number

    def passed(self) -> set[int]:
        """Mutants that were passed since the last time."""
        found: set[int] = self._helpers.__dict__["passed"]
        self._helpers.__dict__["passed"] = set()
        return found
