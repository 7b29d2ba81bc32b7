/** The live scene in three.js: z is up, as in the world. Drawn only when something changes. */

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { player, release, setShown } from "../state/frames";
import { POSE, type Moment } from "./player";

export type CameraName = "overview" | "front" | "top" | "hand";

export interface ViewerEvents {
  onHover(node: string | undefined): void;
  onPoint(x: number, y: number): void; // in the world [m]
  onDrawn(): void;
  onMoving(isMoving: boolean): void;
}

type Point = [number, number, number];
const CAMERAS: Record<CameraName, { eye: Point; target: Point }> = {
  overview: { eye: [1.62, -1.02, 0.86], target: [0.34, 0, 0.24] },
  front: { eye: [1.75, 0, 0.62], target: [0.34, 0, 0.22] },
  top: { eye: [0.41, -0.01, 1.75], target: [0.4, 0, 0] },
  hand: { eye: [0.85, -0.5, 0.42], target: [0.5, 0, 0.12] },
};
const GLOW = new THREE.Color(0x1aa0ff); // what the action is about
const HOVER = new THREE.Color(0x555555);
const WIDTH_DEG = 42; // of the picture, as an angle
const WIDEST = 1.15; // width by height, from which on more is shown at the sides
const LONGEST_TICK = 0.1; // [s]
const STILL = 4; // pixels that the pointer may move in a click
const MARK = { inner: 0.025, outer: 0.035, above: 0.004 }; // [m], of the ring round a place

export class SceneViewer {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(40, 1, 0.02, 20);
  private readonly controls: OrbitControls;
  private readonly resizes: ResizeObserver;
  private model: THREE.Object3D | undefined;
  private nodes: (THREE.Object3D | undefined)[] = [];
  private names = new Map<THREE.Object3D, string>();
  private lit = new Set<string>();
  private hovered: string | undefined;
  private readonly mark = new THREE.Mesh(
    new THREE.RingGeometry(MARK.inner, MARK.outer, 48),
    new THREE.MeshBasicMaterial({ color: GLOW, depthTest: false, transparent: true }),
  );
  private pressed: [number, number] = [0, 0];
  private last = 0;
  private isStale = true;
  private isMoving = false;
  private request = 0;
  private number = -1;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly events: ViewerEvents) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI * 0.55;
    this.controls.minDistance = 0.25;
    this.controls.maxDistance = 4;
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => this.redraw());
    this.resizes = new ResizeObserver(() => this.resize());
    this.resizes.observe(canvas.parentElement ?? canvas);
    canvas.addEventListener("pointermove", this.point);
    canvas.addEventListener("pointerdown", (event) => (this.pressed = [event.clientX, event.clientY]));
    canvas.addEventListener("click", this.click);
    this.mark.visible = false;
    this.scene.add(this.mark);
    canvas.addEventListener("pointerleave", () => this.hover(undefined));
    this.addLights();
    this.look("overview");
    this.tick(performance.now());
  }

  /** Load a scene's model; frames of it are shown from then on. */
  async load(number: number, url: string, names: readonly string[]): Promise<void> {
    const { scene: model } = await new GLTFLoader().loadAsync(url);
    if (this.model) this.scene.remove(this.model);
    this.number = number % 65536;
    this.model = model;
    setShown(true);
    this.names = new Map();
    this.nodes = names.map((name) => {
      const node = model.getObjectByName(THREE.PropertyBinding.sanitizeNodeName(name));
      if (node) this.names.set(node, name);
      return node;
    });
    model.visible = false; // until the first frame says where things are
    model.traverse(prepareMesh);
    this.scene.add(model);
    this.redraw();
  }

  /** Light up nodes ("knife/blade") by their names. */
  light(names: Iterable<string>): void {
    this.lit = new Set(names);
    this.paint();
  }

  /** Mark a place on the table, or none. */
  markPlace(place: readonly [number, number] | undefined): void {
    this.mark.visible = place !== undefined;
    if (place) this.mark.position.set(place[0], place[1], MARK.above);
    this.redraw();
  }

  look(name: CameraName): void {
    const { eye, target } = CAMERAS[name];
    this.camera.position.set(...eye);
    this.controls.target.set(...target);
    this.controls.update();
    this.redraw();
  }

  close(): void {
    setShown(false);
    cancelAnimationFrame(this.request);
    this.resizes.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
  }

  private addLights(): void {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9a8f85, 1.5));
    const sun = new THREE.DirectionalLight(0xffffff, 2);
    sun.position.set(0.9, -0.9, 2);
    sun.target.position.set(0.4, 0, 0);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    sun.shadow.bias = -0.0005;
    sun.shadow.normalBias = 0.005;
    const frustum = sun.shadow.camera;
    [frustum.left, frustum.right, frustum.top, frustum.bottom] = [-1.1, 1.1, 1.1, -1.1];
    [frustum.near, frustum.far] = [0.5, 4];
    this.scene.add(sun, sun.target);
  }

  private readonly tick = (now: number): void => {
    this.request = requestAnimationFrame(this.tick);
    const elapsed = Math.min((now - this.last) / 1000, LONGEST_TICK);
    this.last = now;
    const wasStill = player.isStill;
    const moment = player.advance(elapsed, performance.now());
    if (moment && moment.before.scene === this.number && (!wasStill || !this.model?.visible)) {
      this.pose(moment);
    }
    release(player.time);
    this.setMoving(!wasStill);
    if (this.isStale) this.draw();
  };

  private pose({ before, after, share }: Moment): void {
    if (!this.model) return;
    const turn = new THREE.Quaternion();
    this.nodes.forEach((node, index) => {
      const at = index * POSE;
      if (!node || at + POSE > before.poses.length) return;
      node.position.fromArray(before.poses, at);
      node.position.lerp(new THREE.Vector3().fromArray(after.poses, at), share);
      node.quaternion.fromArray(before.poses, at + 3);
      node.quaternion.slerp(turn.fromArray(after.poses, at + 3), share);
    });
    this.model.visible = true;
    this.redraw();
  }

  private setMoving(isMoving: boolean): void {
    if (isMoving === this.isMoving) return;
    this.isMoving = isMoving;
    this.events.onMoving(isMoving);
  }

  private redraw(): void {
    this.isStale = true;
  }

  private draw(): void {
    this.isStale = false;
    this.renderer.render(this.scene, this.camera);
    if (this.model?.visible) this.events.onDrawn();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement ?? this.canvas;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    // As wide at every shape of the picture, so that a narrow one still holds the table.
    const half = Math.tan(THREE.MathUtils.degToRad(WIDTH_DEG / 2)) / Math.min(this.camera.aspect, WIDEST);
    this.camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(half));
    this.camera.updateProjectionMatrix();
    this.redraw();
  }

  private readonly point = (event: PointerEvent): void => {
    if (!event.buttons) this.hover(this.nameOf(this.hit(event)?.object));
  };

  private readonly click = (event: MouseEvent): void => {
    const moved = Math.hypot(event.clientX - this.pressed[0], event.clientY - this.pressed[1]);
    const found = moved <= STILL ? this.hit(event)?.point : undefined; // else the view was turned
    if (found) this.events.onPoint(found.x, found.y);
  };

  /** What of the model is seen at a place of the screen. */
  private hit(event: MouseEvent): THREE.Intersection | undefined {
    if (!this.model?.visible) return undefined;
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - left)) / width - 1;
    const y = 1 - (2 * (event.clientY - top)) / height;
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return ray.intersectObject(this.model, true)[0];
  }

  private nameOf(object: THREE.Object3D | null | undefined): string | undefined {
    for (let each = object; each; each = each.parent) {
      const name = this.names.get(each);
      if (name) return name;
    }
    return undefined;
  }

  private hover(name: string | undefined): void {
    if (name === this.hovered) return;
    this.hovered = name;
    this.events.onHover(name);
    this.paint();
  }

  private paint(): void {
    this.model?.traverse((each) => {
      if (!(each instanceof THREE.Mesh)) return;
      const name = this.nameOf(each);
      const material = each.material as THREE.MeshStandardMaterial;
      const isLit = name !== undefined && this.lit.has(name);
      material.emissive.copy(isLit ? GLOW : HOVER);
      material.emissiveIntensity = isLit ? 0.85 : name && name === this.hovered ? 0.6 : 0;
    });
    this.redraw();
  }
}

function prepareMesh(each: THREE.Object3D): void {
  if (!(each instanceof THREE.Mesh)) return;
  each.material = (each.material as THREE.Material).clone(); // lit up one by one
  each.castShadow = each.receiveShadow = true;
}
