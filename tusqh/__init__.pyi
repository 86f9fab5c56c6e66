from tusqh.errors import TusqhError as TusqhError
from tusqh.geometry.image import Image as Image
from tusqh.geometry.outline import Outline as Outline
from tusqh.geometry.soup import Soup as Soup
from tusqh.meshes.volume_mesh import VolumeMesh as VolumeMesh
from tusqh.pipeline.materials.result import MaterialsResult as MaterialsResult
from tusqh.pipeline.mesh import mesh as mesh
from tusqh.pipeline.result import Result as Result

__version__: str
