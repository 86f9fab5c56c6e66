from tusqh.errors import TusqhError as TusqhError
from tusqh.pipeline.mesh import mesh as mesh
from tusqh.pipeline.result import Result as Result

__version__: str
