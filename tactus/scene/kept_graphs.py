"""Keeps the graphs of shared terms in the store, because a search may take minutes."""

from collections.abc import Callable
from typing import Any

from golden.layers import sharing
from tactus.core import store
from tactus.core.closure import code


def keep(parts: dict[str, Any], always: bool, search: Callable[[], Any]) -> Any:
    """The kept data of a graph, or those that a search finds.

    A command that only checks a scene leaves nothing behind. So if it need not, a graph is kept
    only once another command has written something.
    """
    if not always and not store.is_there():
        return search()
    return store.cached(store.key("shared_terms", code=code([sharing.__name__]), **parts), search)
