"""The studio's editor in a notebook: the same page and server, with the recipe as it stands as a Python object."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path
from threading import Thread
from types import TracebackType
from typing import TYPE_CHECKING

from ..build import Readable, load
from ..core.arguments import checked
from ..core.errors import printable
from ..recipe.load import to_toml
from ..recipe.recipe import AbstractRecipe
from .drafts import Draft
from .workspace import Workspace

if TYPE_CHECKING:
    from .server import StudioServer

# Height of the frame, pixels; the user can resize it.
EDITOR_HEIGHT = 760
# Seconds between two looks at whether the server is to end.
POLL = 0.05


class Editor:
    """An editor of one recipe, which a notebook displays at the end of a cell.

    Its server starts when it is first displayed or its `url` is read, and ends with `close` or a `with` statement.

    Parameters
    ----------
    workspace : Workspace
        The folder of the recipe, in which it is saved and its files are read.
    draft : Draft
        The recipe at the start.
    name : str
        Name of the recipe as long as it has no file.
    """

    def __init__(self, workspace: Workspace, draft: Draft, name: str = ""):
        self._workspace, self._draft, self._name = workspace, draft, name
        self._server: StudioServer | None = None
        self._thread: Thread | None = None

    @property
    def text(self) -> str:
        """The recipe as it is now in the editor, TOML with comments."""
        return self._shown.text

    @property
    def recipe(self) -> AbstractRecipe:
        """The recipe as it is now in the editor, saved or not; raises RecipeError while a value of it is refused."""
        draft = self._shown
        recipe = draft.recipe
        return recipe if draft.name or not self._name else recipe.with_name(self._name)

    @property
    def url(self) -> str:
        """The address of the page, which any browser on this machine opens."""
        if self._server is None:
            from .server import NOTEBOOKS, StudioServer
            from .service import Studio

            studio = Studio(self._workspace, self._draft.name, self._draft)
            self._server = StudioServer(studio, 0, NOTEBOOKS)
            self._thread = Thread(target=self._server.serve_forever, args=(POLL,), daemon=True)
            self._thread.start()
        return self._server.url

    def close(self) -> None:
        """End the server; the recipe stays as it is, and displaying the editor again starts another server."""
        self._draft = self._shown
        if self._server is not None and self._thread is not None:
            self._server.shutdown()
            self._thread.join()
            self._server.server_close()
        self._server = self._thread = None

    def __enter__(self) -> Editor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        name = printable(self._shown.name or self._name or "a recipe", 60)
        return f"Editor of {name}: its `recipe` is the edited recipe, its `url` the page; close() ends it"

    def _repr_html_(self) -> str:
        style = f"width:100%;height:{EDITOR_HEIGHT}px;border:0;resize:vertical;overflow:auto"
        return f'<iframe title="geomkin studio" style="{style}" src="{escape(self.url)}"></iframe>'

    @property
    def _shown(self) -> Draft:
        kept = None if self._server is None else self._server.studio.kept
        return kept or self._draft


@checked
def edit(recipe: AbstractRecipe | Readable) -> Editor:
    """Edit a recipe in a notebook by dragging and typing, in the same page as that of `geomkin studio`.

    Parameters
    ----------
    recipe : AbstractRecipe, str, Path or mapping
        A recipe, or a source that `load` accepts. The editor saves the recipe of a file in that file; any other under
        a name that the user gives, in the working folder.

    Returns
    -------
    Editor
        Shown at the end of a cell. Its `recipe` is the edited recipe at any time, and `text` the same as TOML; `close`
        ends its server.

    Raises
    ------
    FileError
        If the file cannot be read.
    RecipeError
        If a mapping is no recipe. Mistakes in a file or a text are shown in the editor.

    See Also
    --------
    load, scaled, show

    Notes
    -----
    The browser must run on the same machine as the notebook's kernel, as the page is served to this machine only.

    Examples
    --------
    >>> lengths = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}
    >>> editor = gk.edit({"kind": "four-bar", "linkage": lengths})
    >>> editor.recipe.linkage.crank
    30.0
    >>> editor.close()
    """
    if isinstance(recipe, Path) or (isinstance(recipe, str) and "\n" not in recipe):
        path = Path(recipe)
        workspace, file = Workspace(path.parent), path.name.removesuffix(".toml")
        text = workspace.open(file).text
        return Editor(workspace, Draft(text, workspace.files_of(text), file))
    workspace = Workspace(Path())
    opened = load(recipe) if isinstance(recipe, Mapping) else recipe
    text, name = (opened, "") if isinstance(opened, str) else (to_toml(opened), opened.name)
    return Editor(workspace, Draft(text, workspace.files_of(text)), name)
