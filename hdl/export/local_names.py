"""The local names of a function in one order, whichever Python runs it.

MyHDL declares signals in the order in which a frame lists its names. Python 3.11 lists parameters
and other locals as the code meets them, then by alphabet those that an inner function or a
comprehension uses; what is bound between two looks comes last. Python 3.12 runs a comprehension in
the frame around it, and 3.13 keeps no order between looks, so both would declare otherwise. Here
all do as 3.11, and every Python exports the same bytes.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from types import CodeType, FrameType

_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
# Names in the order in which they were seen, of every function that is running.
_seen: dict[FrameType, list[str]] = {}


class Caller:
    """What MyHDL reads of a frame."""

    def __init__(self, frame: FrameType) -> None:
        self._frame = frame
        self.f_globals = frame.f_globals

    @property
    def f_locals(self) -> dict[str, object]:
        found = dict(self._frame.f_locals)
        code = self._frame.f_code
        inner = _used_inside(code)
        parameters = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
        order = _seen.setdefault(self._frame, [])
        fresh = [name for name in found if name not in order]
        plain = [name for name in fresh if name in parameters or name not in inner]
        order += plain + sorted(set(fresh) - set(plain))
        return {name: found[name] for name in order if name in found}


def forget(running: Iterable[FrameType]) -> None:
    """Keep the order of these frames alone."""
    for frame in _seen.keys() - set(running):
        del _seen[frame]


@cache
def _used_inside(code: CodeType) -> frozenset[str]:
    """Names that functions and comprehensions inside a function take from around them."""
    try:
        source = textwrap.dedent(inspect.getsource(code))
    except OSError:
        source = ""
    if not source.startswith(("@", "def ")):
        return frozenset()
    function = ast.parse(source).body[0]
    nodes = _nodes(ast.iter_child_nodes(function), skip=_handed(function))
    return frozenset().union(*(_taken(node) for node in nodes if _is_scope(node)))


def _taken(scope: ast.AST) -> set[str]:
    nodes = list(_nodes(ast.iter_child_nodes(scope), skip=_handed(scope)))
    names = [node for node in nodes if isinstance(node, ast.Name)]
    own = {node.arg for node in nodes if isinstance(node, ast.arg)}
    own |= {node.name for node in nodes if isinstance(node, ast.FunctionDef)}
    own |= {node.id for node in names if isinstance(node.ctx, ast.Store)}
    return {node.id for node in names}.union(*(_taken(n) for n in nodes if _is_scope(n))) - own


def _nodes(start: Iterable[ast.AST], skip: Sequence[ast.AST] = ()) -> Iterator[ast.AST]:
    """Nodes of one scope; of a scope inside it, what it is handed."""
    for node in start:
        if node not in skip:
            yield node
            yield from _nodes(
                _handed(node) if _is_scope(node) else ast.iter_child_nodes(node), skip
            )


def _is_scope(node: ast.AST) -> bool:
    return isinstance(node, (*_COMPREHENSIONS, ast.FunctionDef, ast.Lambda))


def _handed(scope: ast.AST) -> list[ast.AST]:
    """What is worked out around a scope: first iterable, decorators, defaults."""
    if isinstance(scope, _COMPREHENSIONS):
        return [scope.generators[0].iter]
    assert isinstance(scope, (ast.FunctionDef, ast.Lambda))
    defaults = [*scope.args.defaults, *filter(None, scope.args.kw_defaults)]
    return [*getattr(scope, "decorator_list", []), *defaults]
