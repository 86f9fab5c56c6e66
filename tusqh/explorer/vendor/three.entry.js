export {
  BoxGeometry, BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, EdgesGeometry, GLSL3,
  Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, OrthographicCamera, Scene,
  ShaderMaterial, Vector3, WebGLRenderer,
} from 'three';
export { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
