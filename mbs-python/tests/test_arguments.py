"""What functions take, and what they refuse by name."""

import copy
import pathlib
import pickle
import threading

import mbs
import numpy as np
import pytest
from conftest import model, same_bits

Q = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])


@pytest.mark.parametrize(
    "given",
    [
        Q.tolist(),
        tuple(Q),
        Q.astype(">f8"),
        np.repeat(Q, 2)[::2],
        np.asfortranarray(np.stack([Q, Q]))[0],
        np.frombuffer(b"x" + Q.tobytes(), dtype=np.uint8)[1:].view(np.float64),
        Q.astype(np.longdouble),
    ],
    ids=["list", "tuple", "bytes", "strides", "fortran", "unaligned", "longdouble"],
)
def test_what_can_be_read_as_doubles_is(given):
    arm = model("arm6")
    assert same_bits(arm.mass_matrix(given), arm.mass_matrix(Q))


@pytest.mark.parametrize("kind", [np.float32, np.float16, np.int8, np.uint64, bool])
def test_other_numbers_are_converted(kind):
    arm = model("arm6")
    given = np.array([0, 1, 1, 0, 1, 0]).astype(kind)
    assert same_bits(arm.mass_matrix(given), arm.mass_matrix(given.astype(float)))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (Q[:5], ["q", "(..., 6)", "[5]"]),
        (1.0, ["q", "(..., 6)"]),
        (np.zeros((6, 2)), ["q", "(..., 6)", "[6, 2]"]),
        (Q * np.nan, ["q", "entry 0 is NaN"]),
        (np.array([0, 1, np.inf, 0, 0, 0]), ["q", "entry 2 is inf"]),
        (Q + 1j, ["q", "real numbers"]),
        (["a"] * 6, ["q", "real numbers"]),
        (None, ["q", "real numbers"]),
        ([[1, 2], [3]], ["q"]),
        ([1, 2, 3, 4, 5, 10**400], ["q"]),
        (object(), ["q", "real numbers"]),
        (np.zeros(6, dtype="datetime64[s]"), ["q", "real numbers"]),
    ],
)
def test_what_cannot_is_refused_by_name(given, words):
    with pytest.raises(ValueError) as error:
        model("arm6").mass_matrix(given)
    assert all(word in str(error.value) for word in words), error.value


def test_leading_axes_broadcast():
    arm = model("arm6")
    q, qd = np.random.default_rng(1).uniform(-1, 1, (2, 4, 3, 6))
    whole = arm.bias(q[:, None], qd[None, :, :])
    assert whole.shape == (4, 4, 3, 6)
    for i in range(4):
        for j in range(4):
            for k in range(3):
                assert same_bits(whole[i, j, k], arm.bias(q[i, k], qd[j, k]))
    assert same_bits(arm.bias(Q, qd), np.stack([[arm.bias(Q, row) for row in block] for block in qd]))
    assert arm.bias(np.zeros((0, 6)), Q).shape == (0, 6)
    assert arm.bias(np.zeros((0, 1, 6)), np.zeros((5, 6))).shape == (0, 5, 6)
    with pytest.raises(ValueError, match="qd: its leading axes"):
        arm.bias(np.zeros((3, 6)), np.zeros((4, 6)))


def test_results_are_new_and_inputs_stay():
    arm, q = model("arm6"), Q.copy()
    first = arm.mass_matrix(q)
    first[:] = 7.0
    assert not np.any(arm.mass_matrix(q) == 7.0) and np.array_equal(q, Q)


def test_one_state_of_a_number_is_a_number():
    own = model("pendulum")
    assert isinstance(own.potential_energy([0.0]), float)
    assert own.potential_energy([[0.0], [1.0]]).shape == (2,)


def test_arguments_by_name_and_too_few():
    own = model("pendulum")
    assert same_bits(own.forward_dynamics(u=[1.0], q=[0.2], qd=[0.0]), own.forward_dynamics([0.2], [0.0], [1.0]))
    for wrong in [dict(q=[0.0]), dict(q=[0.0], qd=[0.0], u=[0.0], w=[1.0])]:
        with pytest.raises(TypeError):
            own.forward_dynamics(**wrong)
    with pytest.raises(ValueError, match="expected the arguments q, qd, u, found 1"):
        own._functions[list(own.functions).index("forward_dynamics")]([0.0])
    with pytest.raises(AttributeError, match="did you mean 'gravity'"):
        own.gravitiy  # noqa: B018 - it raises


def test_parameters_by_name():
    own = model("pendulum").with_params(m=2.0)
    assert own.params.m == own.params["m"] == 2.0 and model("pendulum").params.m == 1.0
    own.params.l = 0.5
    own.params.update({"g": 1.6}, b=0.25)
    assert dict(own.params) == {"m": 2.0, "l": 0.5, "g": 1.6, "b": 0.25}
    assert own.params.unit("g") == "m/s^2" and len(own.params) == 4
    assert "g" in own.params and "k" not in own.params and 1 not in own.params
    assert (own.params.get("g"), own.params.get("k"), own.params.get("k", 5)) == (1.6, None, 5)
    before = dict(own.params)
    wrong = [
        ({"l": -1.0}, "`l` must be positive, it is -1.0"),
        ({"m": np.nan}, "`m` must be finite"),
        ({"m": -1.0}, "`m`"),
        ({"k": 1.0}, "there is no parameter 'k'"),
        ({"m": [1.0, 2.0]}, "m: expected the shape ()"),
        ({"m": "1"}, "m: real numbers"),
        ({"m": 3.0, "l": 0.0}, "`l`"),
        ({"m": 1j}, "m: real numbers"),
    ]
    for values, words in wrong:
        with pytest.raises(ValueError) as error:
            own.params.update(values)
        assert words in str(error.value)
    assert dict(own.params) == before
    with pytest.raises(AttributeError, match="did you mean 'm'|there is no parameter"):
        own.params.mm  # noqa: B018 - it raises


def test_arrays_of_parameters():
    text = """mechanism Masses {
        param mass[3]: kg = [1, 2, 3]; param inertia[2][2]: kg = [[1, 0], [0, 1]];
        coord x[3]: m; coord y[2]: m;
        for i in 0..3 { kinetic += 1/2*mass[i]*dt(x[i])^2; }
        for i in 0..2 { kinetic += 1/2*inertia[i][i]*dt(y[i])^2 + inertia[0][1]*dt(y[0])*dt(y[1])/2; }
    }"""
    own = mbs.compile(text)
    own.params.mass[1] = 5.0
    assert own.params.mass.tolist() == [1, 5, 3] and own.params["mass_1"] == 5.0
    own.params["mass_2"] = 7.0
    own.params.mass = own.params.mass * 2
    assert np.diag(own.mass_matrix(np.zeros(5)))[:3].tolist() == [2, 10, 14]
    own.params.inertia[0, 1] = 0.25
    assert own.params.inertia.tolist() == [[1, 0.25], [0, 1]]
    assert own.mass_matrix(np.zeros(5))[3, 4] == 0.25
    with pytest.raises(ValueError, match="mass"):
        own.params.mass[0] = -1.0
    with pytest.raises(ValueError, match="expected the shape"):
        own.params.mass = [1, 2]
    assert own.params.mass.tolist() == [2, 10, 14]
    # Operators in place set what they change; views and other ways to write say that they do not.
    held = own.params.mass
    own.params.mass *= 2
    held += 1
    assert own.params.mass.tolist() == [5, 21, 29] == held.tolist()
    own.params.mass = [4, 5, 6]
    held[0] = 1
    assert own.params.mass.tolist() == [1, 5, 6] == held.tolist()
    for write in [
        lambda: own.params.inertia[0].__setitem__(1, 7.0),
        lambda: own.params.mass[1:].__setitem__(0, 7.0),
        lambda: own.params.mass.fill(7.0),
        lambda: np.negative(held, out=held),
    ]:
        with pytest.raises(ValueError, match="read-only"):
            write()
    assert own.params == own.with_params().params == copy.copy(own.params) != own.with_params(mass=[1, 2, 3]).params
    doubled = held * 2
    doubled[0] = 9
    assert own.params.mass.tolist() == [1, 5, 6] and doubled.tolist() == [9, 10, 12]


def test_parameters_that_are_assigned_together():
    own = model("pendulum").with_params()
    own.params = {"m": 2.0, "l": 0.5}
    assert (own.params.m, own.params.l) == (2.0, 0.5)
    assert copy.copy(own.params) == dict(own.params) == pickle.loads(pickle.dumps(own.params))
    own = mbs.compile("mechanism A { param unit: kg = 1; coord x: m; kinetic += unit*dt(x)^2/2; }")
    with pytest.raises(AttributeError, match="params.unit is no parameter"):
        own.params.unit = 2.0
    own.params["unit"] = 2.0
    assert own.mass_matrix([0.0]) == 2.0


def test_names_of_python_are_no_trouble():
    own = mbs.compile("""mechanism class_ { param lambda: kg = 1; coord def: m; kinetic += lambda*dt(def)^2/2;
        output simulate = def; output name = 2*def; output functions = 3*def; output None = def; output yield = 4*def; }""")
    found = {name: own.functions[name]([2.0]) for name in ["simulate", "name", "functions", "None", "yield"]}
    assert found == {"simulate": 2.0, "name": 4.0, "functions": 6.0, "None": 2.0, "yield": 8.0}
    assert own.simulate_([2.0]) == 2.0 and own.name == "class_" and own.yield_([2.0]) == 8.0
    assert own.params["lambda"] == 1.0 and len(own.simulate([1.0], t=1.0)) > 1
    own = mbs.compile(
        "mechanism A { coord x: m; coord y: m; kinetic += 1 kg*(dt(x)^2 + dt(y)^2)/2; output name = x; "
        "output name_ = y; output _core = 2*x; }"
    )
    assert {name: own.functions[name]([2.0, 3.0]) for name in ["name", "name_", "_core"]} == {
        "name": 2.0,
        "name_": 3.0,
        "_core": 4.0,
    }


def test_results_that_are_too_large():
    own = model("pendulum")
    many, promises = 1 << 19, pathlib.Path("/proc/sys/vm/overcommit_memory")
    # Linux may be told to promise all memory that is asked for.
    if promises.exists() and promises.read_text().strip() != "1":
        with pytest.raises(MemoryError):
            own.forward_dynamics(np.zeros((many, 1, 1)), np.zeros((1, many, 1)), [0.0])
    with pytest.raises(ValueError, match="64"):
        own.mass_matrix(np.zeros((1,) * 63 + (1,)))


def test_copies_are_models():
    own = model("pendulum")
    assert own.with_params().params is not own.params
    for other in [copy.copy(own), copy.deepcopy(own)]:
        other.params.m = 3.0
        assert own.params.m == 1.0 and other.mass_matrix([0.0]) == 3 * own.mass_matrix([0.0])


def test_models_travel_to_other_processes():
    mechanism = mbs.Mechanism("Mass")
    x, m = mechanism.coord("x", "m"), mechanism.param("m", "kg", 1.0)
    mechanism.kinetic(m * x.dt() ** 2 / 2)
    for own in [model("pendulum").with_params(m=2.5), mbs.compile(mechanism, params={"m": 4.0})]:
        other = pickle.loads(pickle.dumps(own))
        assert dict(other.params) == dict(own.params)
        assert same_bits(other.mass_matrix([0.3]), own.mass_matrix([0.3]))


def test_results_travel_to_other_processes():
    found = model("double_pendulum").linearize([0.1, 0.2], [0.0, 0.0])
    for other in [pickle.loads(pickle.dumps(found)), copy.copy(found), copy.deepcopy(found)]:
        assert type(other) is type(found) and other._fields == found._fields == ("q", "qd", "u")
        assert all(map(same_bits, other, found))


def test_pickled_models_are_those_of_the_texts_of_then(tmp_path):
    (tmp_path / "mass.mbs").write_text("const half = 1/2;")
    (tmp_path / "a.mbs").write_text(
        'import "mass.mbs"; mechanism A { param m: kg = 2; coord z: m; kinetic += half*m*dt(z)^2; }'
    )
    own = mbs.compile(tmp_path / "a.mbs", params={"m": 3.0})
    kept = pickle.dumps(own)
    for file in tmp_path.iterdir():
        file.unlink()
    assert pickle.loads(kept).mass_matrix([0.0]) == 3.0


def test_many_threads_of_python_at_once():
    arm = model("arm6").with_params()
    q = np.random.default_rng(2).uniform(-1, 1, (500, 6))
    expected, wrong = arm.mass_matrix(q), []

    def work():
        for _ in range(20):
            if not same_bits(arm.mass_matrix(q), expected):
                wrong.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert not wrong
