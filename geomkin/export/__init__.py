"""Parts and tables as files. Nothing here knows a mechanism."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .job import Job as Job
    from .title import Title as Title
    from .writers import WRITERS as WRITERS
    from .writers import Writer as Writer
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
