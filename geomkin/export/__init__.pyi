# The public names of this package. Each is imported when it is first used.
from .formats import WRITERS as WRITERS
from .formats import Writer as Writer
from .job import Job as Job
from .text import Title as Title
