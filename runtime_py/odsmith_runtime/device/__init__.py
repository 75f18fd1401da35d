"""A device in Python: the twin of the C runtime, from the same tables, equal to it byte by byte.

    node = Node(Tables.of(tmcm6212), port, Config(node_id=5))

A module here has the name of its counterpart in C. `CONTRACT.md` says what both do.
"""

from __future__ import annotations

from .node import Config as Config
from .node import Node as Node
from .port import Can as Can
from .port import DriverFlags as DriverFlags
from .port import Frame as Frame
from .port import Input as Input
from .port import Lines as Lines
from .port import MemoryFailure as MemoryFailure
from .port import MotorAnswer as MotorAnswer
from .port import MotorDemand as MotorDemand
from .port import OsStatus as OsStatus
from .port import Output as Output
from .port import Port as Port
from .tables import Tables as Tables
