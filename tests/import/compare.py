"""Holds imported robots against Pinocchio and MuJoCo.

    python tests/import/compare.py --mbs target/release/mbs --out tests/import/results.json
    python tests/import/compare.py --mbs target/release/mbs --small tests/import/reference.json

The first call imports robots of PyPI's example-robot-data and the MJCF files of this folder, and compares, at random
states, the mass matrix, the bias C q̇ + G and gravity with Pinocchio's and MuJoCo's: the greatest difference over the
greatest entry. Links whose inertia no body has are in `any_inertia`: both programs take it as it is. The second writes
what Pinocchio and MuJoCo give for the small robots of this folder, which `cargo test` compares with. Both need `pip install pin mujoco example-robot-data numpy`.

Attitudes of free bodies and ball joints are unit quaternions e here, of which Pinocchio and MuJoCo use the angular
velocity: with q̇ = T(q) v the compared matrices are Tᵀ M T and Tᵀ (M Ṫ v + C q̇ + G).
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SEED = 20190718
STATES = 5

# Name, file of example-robot-data, whether its base is free.
ROBOTS = [
    ("UR5", "ur_description/urdf/ur5_robot.urdf", False),
    ("UR10", "ur_description/urdf/ur10_robot.urdf", False),
    ("Kinova", "kinova_description/robots/kinova.urdf", False),
    ("Panda", "panda_description/urdf/panda.urdf", False),
    ("Allegro hand", "allegro_hand_description/urdf/allegro_right_hand.urdf", False),
    ("Solo 12", "solo_description/robots/solo12.urdf", False),
    ("Solo 12, free", "solo_description/robots/solo12.urdf", True),
    ("ANYmal B", "anymal_b_simple_description/robots/anymal.urdf", False),
    ("ANYmal B, free", "anymal_b_simple_description/robots/anymal.urdf", True),
    ("Go2", "go2_description/urdf/go2.urdf", False),
    ("G1", "g1_description/urdf/g1_29dof_rev_1_0.urdf", False),
    ("Alex, hands", "alex_description/urdf/alex_sake_hands.urdf", False),
    ("Talos arm", "talos_data/robots/talos_left_arm.urdf", False),
    ("Talos", "talos_data/robots/talos_reduced.urdf", False),
]

SMALL = [("arm.urdf", []), ("rover.urdf", []), ("drone.urdf", []), ("walker.xml", []), ("linkage.xml", [])]


def run(mbs, *arguments):
    done = subprocess.run([mbs, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr[:2000])
    return done.stdout


# ---- quaternions, scalar part first


def product(a, b):
    w, v, x, u = a[0], a[1:], b[0], b[1:]
    return np.concatenate([[w * x - v @ u], w * u + x * v + np.cross(v, u)])


def rotation(e):
    w, x, y, z = e
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def rate_matrix(e):
    """ė = E(e) ω, ω in the axes of the body; linear in e."""
    return np.array([0.5 * product(e, np.concatenate([[0.0], axis])) for axis in np.eye(3)]).T


def skew(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


class State:
    """q and v of the other program, as coordinates of mbs: q̇ = T v."""

    def __init__(self, coordinates, dof):
        self.index = {name: i for i, name in enumerate(coordinates)}
        n = len(coordinates)
        self.q, self.t, self.t_dot = np.zeros(n), np.zeros((n, dof)), np.zeros((n, dof))

    def number(self, name, value, column):
        self.q[self.index[name]] = value
        self.t[self.index[name], column] = 1.0

    def attitude(self, name, e, w, columns):
        rows = [self.index[f"{name}_attitude_{i}"] for i in range(4)]
        self.q[rows] = e
        self.t[np.ix_(rows, columns)] = rate_matrix(e)
        self.t_dot[np.ix_(rows, columns)] = rate_matrix(rate_matrix(e) @ w)

    def place(self, name, r, turn, turn_dot, columns):
        rows = [self.index[f"{name}_place_{i}"] for i in range(3)]
        self.q[rows] = r
        self.t[np.ix_(rows, columns)] = turn
        self.t_dot[np.ix_(rows, columns)] = turn_dot


# ---- Pinocchio


class Pinocchio:
    name = "pinocchio"

    def __init__(self, file, free):
        import pinocchio as pin

        self.pin = pin
        root = pin.JointModelFreeFlyer() if free else None
        arguments = dict(mimic=True) if root is None else dict(root_joint=root, mimic=True)
        try:
            self.model = pin.buildModelFromUrdf(file, **arguments)
        except TypeError:
            self.model = pin.buildModelFromUrdf(file) if root is None else pin.buildModelFromUrdf(file, root)
        self.data = self.model.createData()
        tree = ElementTree.parse(file).getroot()
        self.damping = {
            joint.get("name"): float(joint.find("dynamics").get("damping", 0))
            for joint in tree.findall("joint")
            if joint.find("dynamics") is not None
        }
        self.free_name = None
        if free:
            children = {joint.find("child").get("link") for joint in tree.findall("joint")}
            (root_link,) = [link.get("name") for link in tree.findall("link") if link.get("name") not in children]
            self.free_name = f"{root_link}_joint"

    def states(self, coordinates, random):
        pin, model = self.pin, self.model
        for _ in range(STATES):
            q, v = pin.neutral(model), random.uniform(-1, 1, model.nv)
            state = State(coordinates, model.nv)
            for joint, name in list(zip(model.joints, model.names))[1:]:
                name = self.free_name if name == "root_joint" else name
                name = "".join(c if c.isascii() and c.isalnum() else "_" for c in name)
                kind, i, k = joint.shortname(), joint.idx_q, joint.idx_v
                if "Mimic" in kind:
                    continue
                if "FreeFlyer" in kind:
                    e = random.normal(size=4)
                    e /= np.linalg.norm(e)
                    r = random.uniform(-1, 1, 3)
                    q[i : i + 3], q[i + 3 : i + 6], q[i + 6] = r, e[1:], e[0]
                    w, turn = v[k + 3 : k + 6], rotation(e)
                    state.place(name, r, turn, turn @ skew(w), list(range(k, k + 3)))
                    state.attitude(name, e, w, list(range(k + 3, k + 6)))
                elif "Planar" in kind:
                    x, y, angle = random.uniform(-1, 1, 3)
                    q[i : i + 4] = x, y, np.cos(angle), np.sin(angle)
                    c, s, w = np.cos(angle), np.sin(angle), v[k + 2]
                    rows = [state.index[f"{name}_x"], state.index[f"{name}_y"]]
                    state.q[rows] = x, y
                    state.t[np.ix_(rows, [k, k + 1])] = [[c, -s], [s, c]]
                    state.t_dot[np.ix_(rows, [k, k + 1])] = w * np.array([[-s, -c], [c, -s]])
                    state.number(f"{name}_angle", angle, k + 2)
                elif joint.nq == 2:
                    angle = random.uniform(-np.pi, np.pi)
                    q[i : i + 2] = np.cos(angle), np.sin(angle)
                    state.number(name, angle, k)
                else:
                    q[i] = random.uniform(-np.pi, np.pi)
                    state.number(name, q[i], k)
            m = pin.crba(model, self.data, q)
            m = np.triu(m) + np.triu(m, 1).T
            bias = pin.nonLinearEffects(model, self.data, q, v).copy()
            gravity = pin.computeGeneralizedGravity(model, self.data, q).copy()
            loss = np.zeros(model.nv)
            for joint, name in list(zip(model.joints, model.names))[1:]:
                if joint.nv == 1 and "Mimic" not in joint.shortname():
                    loss[joint.idx_v] = self.damping.get(name, 0.0) * v[joint.idx_v]
            yield state, v, m, bias, gravity, loss


# ---- MuJoCo


class Mujoco:
    name = "mujoco"

    def __init__(self, file, _free):
        import mujoco

        self.mujoco = mujoco
        self.model = mujoco.MjModel.from_xml_path(file)
        self.data = mujoco.MjData(self.model)

    def states(self, coordinates, random):
        mujoco, model, data = self.mujoco, self.model, self.data
        for _ in range(STATES):
            v = random.uniform(-1, 1, model.nv)
            state = State(coordinates, model.nv)
            for j in range(model.njnt):
                name, i, k = model.joint(j).name, model.jnt_qposadr[j], model.jnt_dofadr[j]
                name = "".join(c if c.isascii() and c.isalnum() else "_" for c in name)
                kind = model.jnt_type[j]
                e = random.normal(size=4)
                e /= np.linalg.norm(e)
                if kind == mujoco.mjtJoint.mjJNT_FREE:
                    r = random.uniform(-1, 1, 3)
                    data.qpos[i : i + 3], data.qpos[i + 3 : i + 7] = r, e
                    state.place(name, r, np.eye(3), np.zeros((3, 3)), list(range(k, k + 3)))
                    state.attitude(name, e, v[k + 3 : k + 6], list(range(k + 3, k + 6)))
                elif kind == mujoco.mjtJoint.mjJNT_BALL:
                    data.qpos[i : i + 4] = e
                    state.attitude(name, e, v[k : k + 3], list(range(k, k + 3)))
                else:
                    data.qpos[i] = random.uniform(-1, 1)
                    state.number(name, data.qpos[i], k)
            data.qvel[:] = v
            mujoco.mj_forward(model, data)
            m = np.zeros((model.nv, model.nv))
            mujoco.mj_fullM(model, data, m) if self.order() else mujoco.mj_fullM(model, m, data.qM)
            # Springs are part of V here, dampers of D.
            bias = data.qfrc_bias - data.qfrc_spring
            spring, loss = data.qfrc_spring.copy(), -data.qfrc_damper
            residuals = {}
            for row in range(data.nefc):
                if data.efc_type[row] == mujoco.mjtConstraint.mjCNSTR_EQUALITY:
                    name = model.equality(data.efc_id[row]).name
                    residuals.setdefault(name, []).append(float(data.efc_pos[row]))
            data.qvel[:] = 0
            mujoco.mj_forward(model, data)
            self.residuals = residuals
            yield state, v, m, bias, data.qfrc_bias - spring, loss

    def order(self):
        """Whether mj_fullM takes the data before its result."""
        return "MjData" in (self.mujoco.mj_fullM.__doc__ or "").split("dst")[0]


# ---- comparison


def values(mbs, mechanism, state, q_dot, only):
    request = {"q": state.q.tolist(), "qd": q_dot.tolist()}
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(request, file)
        file.flush()
        return json.loads(run(mbs, "eval", mechanism, "--state", file.name, "--only", ",".join(only)))


def coordinates_of(mbs, mechanism):
    described = json.loads(run(mbs, "derive", mechanism, "--emit", "json"))
    names = []
    for variable in described["coordinates"]:
        names.extend(component_names(variable))
    return names


def component_names(variable):
    if isinstance(variable, str):
        return [variable]
    length = variable.get("length")
    return [variable["name"]] if length is None else [f"{variable['name']}_{i}" for i in range(length)]


def relative(found, expected):
    return float(np.max(np.abs(found - expected)) / max(np.max(np.abs(expected)), 1e-12))


def projected(state, v, found):
    """Tᵀ M T, Tᵀ (M Ṫ v + h), Tᵀ G."""
    m, h, g = (np.array(found[name]) for name in ("mass_matrix", "bias", "gravity"))
    t = state.t
    return t.T @ m @ t, t.T @ (m @ (state.t_dot @ v) + h), t.T @ g


def compare(mbs, other, mechanism):
    """The greatest relative differences of M, bias and gravity."""
    names = coordinates_of(mbs, mechanism)
    random = np.random.default_rng(SEED)
    worst = [0.0, 0.0, 0.0]
    for state, v, m, bias, gravity, _ in other.states(names, random):
        found = values(mbs, mechanism, state, state.t @ v, ["mass_matrix", "bias", "gravity"])
        ours = projected(state, v, found)
        worst = [max(w, relative(a, b)) for w, a, b in zip(worst, ours, (m, bias, gravity))]
    return len(names), worst


def other_of(file, free):
    return (Mujoco if file.endswith(".xml") else Pinocchio)(file, free)


def imported_as_is(mbs, path, mechanism, options):
    """Imports a robot with the inertias that its file has; the links whose inertia no body has."""
    command = [mbs, "import", path, "--out", mechanism, "--any-inertia", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr[:2000])
    found = re.findall("(?:no body has the inertia|the inertia) of the link `(.*?)`(?:: a| has a negative)", done.stderr)
    return sorted(set(found))


def folder_of_robots():
    import pinocchio

    above = os.path.dirname(os.path.abspath(pinocchio.__file__))
    while above != "/":
        candidate = os.path.join(above, "share", "example-robot-data", "robots")
        if os.path.isdir(candidate):
            return candidate
        above = os.path.dirname(above)
    raise RuntimeError("example-robot-data is not installed")


def large(mbs, out, only):
    results, robots = [], folder_of_robots()
    work = [(name, os.path.join(robots, file), file, free) for name, file, free in ROBOTS]
    work += [(file, os.path.join(HERE, "robots", file), file, False) for file in os.listdir(os.path.join(HERE, "robots")) if file.endswith(".xml")]
    for name, path, file, free in work:
        if only and not any(word in name for word in only):
            continue
        with tempfile.TemporaryDirectory() as folder:
            mechanism = os.path.join(folder, "robot.mbs")
            begin = time.time()
            try:
                impossible = imported_as_is(mbs, path, mechanism, ["--floating"] if free else [])
                imported = time.time()
                run(mbs, "--no-cache", "derive", mechanism)
                derived = time.time()
                other = other_of(path, free)
                n, (m, bias, gravity) = compare(mbs, other, mechanism)
                row = dict(robot=name, file=file, against=other.name, coordinates=n, states=STATES)
                row |= dict(mass_matrix=float(f"{m:.2e}"), bias=float(f"{bias:.2e}"), gravity=float(f"{gravity:.2e}"))
                row |= dict(any_inertia=impossible) if impossible else {}
                times = f"import {imported - begin:.2f} s, derive {derived - imported:.2f} s"
            except (RuntimeError, ValueError, KeyError) as error:
                row, times = dict(robot=name, file=file, refused=str(error).strip().splitlines()[0]), ""
            print(row, times, flush=True)
            results.append(row)
    if out:
        with open(out, "w") as file:
            rows = ",\n".join(f"    {json.dumps(row, ensure_ascii=False)}" for row in results)
            file.write('{\n  "seed": %d,\n  "robots": [\n%s\n  ]\n}\n' % (SEED, rows))
    return all(max(row.get(k, 1.0) for k in ("mass_matrix", "bias", "gravity")) < 1e-9 for row in results)


def small(mbs, out):
    """What the other programs give for the small robots: accelerations without inputs, M, bias, gravity."""
    robots = []
    for file, options in SMALL:
        path = os.path.join(HERE, "robots", file)
        with tempfile.TemporaryDirectory() as folder:
            mechanism = os.path.join(folder, "robot.mbs")
            run(mbs, "import", path, "--out", mechanism, *options)
            names = coordinates_of(mbs, mechanism)
        other, states = other_of(path, False), []
        for state, v, m, bias, gravity, loss in other.states(names, np.random.default_rng(SEED)):
            entry = dict(q=state.q.tolist(), qd=(state.t @ v).tolist())
            square = state.t.shape[0] == state.t.shape[1] and np.array_equal(state.t, np.eye(len(v)))
            if square:
                entry |= dict(mass_matrix=m.tolist(), bias=bias.tolist(), gravity=gravity.tolist())
            residuals = getattr(other, "residuals", {})
            if residuals:
                entry["residuals"] = residuals
            else:
                acceleration = np.linalg.solve(m, -bias - loss)
                entry["qdd"] = (state.t @ acceleration + state.t_dot @ v).tolist()
            states.append(entry)
        robots.append(dict(file=file, against=other.name, coordinates=names, states=states))
    with open(out, "w") as file:
        json.dump(dict(seed=SEED, robots=robots), file, indent=1)
        file.write("\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mbs", default="target/release/mbs")
    parser.add_argument("--out")
    parser.add_argument("--small")
    parser.add_argument("--only", nargs="*")
    arguments = parser.parse_args()
    if arguments.small:
        small(arguments.mbs, arguments.small)
        return 0
    return 0 if large(arguments.mbs, arguments.out, arguments.only) else 1


if __name__ == "__main__":
    sys.exit(main())
