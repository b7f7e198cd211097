"""FMUs of a mechanism in FMPy, against `mbs simulate` and differences of their own derivatives.

    python validate.py MBS FOLDER CASES.json

CASES.json is a list of objects: "model" (a file), "state" (as `mbs simulate --state` takes it, all of it given),
"t_end", "dt", and on request "inputs" ({name: [slope, offset, …]}: polynomials in t, highest power first) with "drive"
(the same as arguments of `mbs simulate`), "events" (how many there are at least) and "substeps" (of model exchange in
"dt"). Both versions of the standard, model exchange (a classical Runge-Kutta method here, and FMPy's CVode) and
co-simulation, must agree with the program to 1e-9 relative to the largest value of each variable or 1.
"""

import csv
import ctypes
import io
import json
import pathlib
import subprocess
import sys

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.simulation import instantiate_fmu
from fmpy.validation import validate_fmu

BOUND = 1e-9


def run(*command):
    return subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True).stdout


def reference(mbs, case):
    state, drive = dict(case["state"]), case.get("drive", [])
    if "--signal" in drive:
        del state["prescribed"]  # the formulas are in its place
    text = run(mbs, "simulate", case["model"], "--state", json.dumps(state), "--t-end", case["t_end"],
               "--dt", case["dt"], "--rtol", "1e-13", "--atol", "1e-15", *drive)
    rows = list(csv.reader(io.StringIO(text)))
    return rows[0], np.array(rows[1:], float)


def signal_names(case):
    return case["state"].get("prescribed", {})


class Instance:
    """An instance of either version, by the same names."""

    def __init__(self, path, kind):
        self.description = read_model_description(path)
        self.folder = extract(path)
        self.is_3 = self.description.fmiVersion.startswith("3")
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.fmu = instantiate_fmu(self.folder, self.description, kind)
        fmu = self.fmu
        self.get = fmu.getFloat64 if self.is_3 else fmu.getReal
        self.set = fmu.setFloat64 if self.is_3 else fmu.setReal
        self.n = self.description.numberOfContinuousStates if kind == "ModelExchange" else 0
        self.nz = self.description.numberOfEventIndicators if kind == "ModelExchange" else 0

    def initialize(self, tolerance=None):
        if self.is_3:
            self.fmu.enterInitializationMode(tolerance=tolerance)
        else:
            self.fmu.setupExperiment(tolerance=tolerance)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def update(self):
        """Ends event mode; returns whether states have changed."""
        answer = self.fmu.updateDiscreteStates() if self.is_3 else self.fmu.newDiscreteStates()
        assert not answer[0] and not answer[1]
        self.fmu.enterContinuousTimeMode()
        return answer[3]

    def states(self):
        x = (ctypes.c_double * self.n)()
        self.fmu.getContinuousStates(x, self.n)
        return np.array(x)

    def derivatives(self, t, x, inputs):
        self.fmu.setTime(t)
        for vr, polynomial in inputs:
            self.set([vr], [np.polyval(polynomial, t)])
        self.fmu.setContinuousStates((ctypes.c_double * self.n)(*x), self.n)
        dx = (ctypes.c_double * self.n)()
        (self.fmu.getContinuousStateDerivatives if self.is_3 else self.fmu.getDerivatives)(dx, self.n)
        return np.array(dx)

    def indicators(self):
        z = (ctypes.c_double * self.nz)()
        self.fmu.getEventIndicators(z, self.nz)
        return np.array(z)


def driven(instance, case):
    """Value references and polynomials of the inputs; of signals the derivatives, too."""
    inputs = []
    for name, polynomial in case.get("inputs", {}).items():
        inputs.append((instance.vr[name], polynomial))
        if name in signal_names(case):
            inputs.append((instance.vr[name + "_dot"], np.polyder(polynomial)))
            inputs.append((instance.vr[name + "_ddot"], np.polyder(polynomial, 2)))
    return inputs


def model_exchange(path, case, times, names):
    """A master with a classical Runge-Kutta method that ends its steps at events."""
    a = Instance(path, "ModelExchange")
    inputs = driven(a, case)
    a.initialize()
    a.update()
    x, t, events = a.states(), 0.0, 0
    vrs = [a.vr[name] for name in names]
    f = lambda t, x: a.derivatives(t, x, inputs)

    def step(t, x, h):
        k1 = f(t, x)
        k2 = f(t + h / 2, x + h / 2 * k1)
        k3 = f(t + h / 2, x + h / 2 * k2)
        k4 = f(t + h, x + h * k3)
        end = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        f(t + h, end)
        return end

    rows = [a.get(vrs)]
    for goal in times[1:]:
        count = case.get("substeps", 50)
        length = (goal - t) / count
        while goal - t > 1e-13:
            h = min(length, goal - t)
            f(t, x)
            before = a.indicators() > 0
            end = step(t, x, h)
            if a.nz and np.any((a.indicators() > 0) != before):
                low, high = 0.0, h
                while high - low > 1e-14:
                    middle = (low + high) / 2
                    step(t, x, middle)
                    low, high = (low, middle) if np.any((a.indicators() > 0) != before) else (middle, high)
                h, end, events = high, step(t, x, high), events + 1
                a.fmu.enterEventMode()
                a.update()
            t, x = t + h, end
            answer = a.fmu.completedIntegratorStep()
            if answer[0]:
                a.fmu.enterEventMode()
                if a.update():
                    x = a.states()
        t = goal
        f(t, x)
        rows.append(a.get(vrs))
    check_directions(a, case)
    a.fmu.terminate()
    a.fmu.freeInstance()
    assert events >= case.get("events", 0), f"{events} events"
    return np.array(rows), events


def promises(folder):
    """FMPy 0.3 does not read the attribute of FMI 3."""
    return 'providesDirectionalDerivatives="true"' in (pathlib.Path(folder) / "modelDescription.xml").read_text()


def check_directions(a, case):
    """Directional and adjoint derivatives against central differences of what they differentiate."""
    md = a.description
    signals = {name + suffix for name in signal_names(case) for suffix in ("", "_dot", "_ddot")}
    promised = md.modelExchange.providesDirectionalDerivative or promises(a.folder)
    assert promised == (not signals), "promised are derivatives by all inputs"
    derivatives = [v for v in md.modelVariables if v.name.startswith("der(")]
    unknowns = [v.valueReference for v in derivatives]
    states = [v.derivative.valueReference for v in derivatives]
    outputs = [v for v in md.modelVariables if v.causality == "output" and v.valueReference not in states]
    if any(v.name.startswith("lambda_") for v in md.modelVariables):
        # Rotations by quaternions turn as rotations do along motions of unit quaternions alone.
        outputs = [v for v in outputs if "_rotation_" not in v.name]
    unknowns += [v.valueReference for v in outputs]
    inputs = [v for v in md.modelVariables if v.causality == "input" and v.name not in signals]
    knowns = states + [v.valueReference for v in inputs]
    x = a.states()

    def evaluated(column, h):
        if column < a.n:
            shifted = x.copy()
            shifted[column] += h
            a.fmu.setContinuousStates((ctypes.c_double * a.n)(*shifted), a.n)
            values = np.array(a.get(unknowns))
            a.fmu.setContinuousStates((ctypes.c_double * a.n)(*x), a.n)
        else:
            value = a.get([knowns[column]])[0]
            a.set([knowns[column]], [value + h])
            values = np.array(a.get(unknowns))
            a.set([knowns[column]], [value])
        return values

    worst = 0.0
    for column, known in enumerate(knowns):
        found = np.array(a.fmu.getDirectionalDerivative(unknowns, [known], [1.0]))
        h = 1e-3
        # Of order 6.
        steps = ((1, 45), (2, -9), (3, 1))
        expected = sum(c * (evaluated(column, k * h) - evaluated(column, -k * h)) for k, c in steps) / (60 * h)
        error_here = np.abs(found - expected) / (1 + np.max(np.abs(expected)))
        assert np.max(error_here) < case.get("directions_bound", 1e-8), (known, unknowns, found, expected)
        worst = max(worst, np.max(error_here))
        if a.is_3:
            for row, unknown in enumerate(unknowns):
                adjoint = a.fmu.getAdjointDerivative([unknown], [known], [1.0])
                assert adjoint[0] == found[row], (adjoint, found[row])
    case["directions_worst"] = max(case.get("directions_worst", 0.0), worst)


def co_simulation(path, case, times, names):
    a = Instance(path, "CoSimulation")
    inputs = driven(a, case)
    vrs = [a.vr[name] for name in names]
    for vr, polynomial in inputs:
        a.set([vr], [np.polyval(polynomial, 0.0)])
    a.initialize(tolerance=1e-13)
    rows = [a.get(vrs)]
    signals = {a.vr[name + suffix] for name in signal_names(case) for suffix in ("", "_dot", "_ddot")}
    for t, goal in zip(times, times[1:]):
        for vr, polynomial in inputs:
            a.set([vr], [np.polyval(polynomial, t)])
            slopes = [(order, np.polyval(np.polyder(polynomial, order), t)) for order in (1, 2, 3)]
            if vr in signals:
                continue  # they follow their own rates
            if a.is_3:
                assert all(value == 0 for _, value in slopes), "FMI 3 has no derivatives of inputs"
            else:
                for order, value in slopes:
                    set_slope(a, vr, order, value)
        a.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=goal - t)
        rows.append(a.get(vrs))
    a.fmu.terminate()
    a.fmu.freeInstance()
    return np.array(rows)


def set_slope(a, vr, order, value):
    a.fmu.fmi2SetRealInputDerivatives(
        a.fmu.component, (ctypes.c_uint * 1)(vr), 1, (ctypes.c_int * 1)(order), (ctypes.c_double * 1)(value))


def error(found, expected):
    scale = 1 + np.max(np.abs(expected), axis=0)
    return float(np.max(np.abs(found - expected) / scale))


def main(mbs, folder, cases):
    for case in json.loads(pathlib.Path(cases).read_text()):
        header, rows = reference(mbs, case)
        times = rows[:, 0]
        stem = pathlib.Path(case["model"]).stem
        for version in ("2", "3"):
            path = str(pathlib.Path(folder) / f"{stem}_{version}.fmu")
            run(mbs, "fmu", case["model"], "--fmi", version, "--state", json.dumps(case["state"]), "--out", path)
            problems = validate_fmu(path)
            assert not problems, problems
            known = {v.name for v in read_model_description(path).modelVariables}
            names = [name for name in header[1:] if name in known]
            expected = rows[:, [header.index(name) for name in names]]
            found, events = model_exchange(path, case, times, names)
            errors = {"ME": error(found, expected)}
            of_inputs = [p for name, p in case.get("inputs", {}).items() if name not in signal_names(case)]
            constant = all(len(np.trim_zeros(p, "f")) <= 1 for p in of_inputs)
            if version == "2" or constant:
                errors["CS"] = error(co_simulation(path, case, times, names), expected)
            worst = max(errors.values())
            assert worst < case.get("bound", BOUND), f"{stem}, FMI {version}: {errors}"
            if "inputs" not in case:
                # FMPy's own master; CVode is as good as multistep methods with these tolerances are.
                result = simulate_fmu(path, fmi_type="ModelExchange", stop_time=times[-1],
                                      output_interval=case["dt"] / 20, relative_tolerance=1e-10, output=names)
                every = np.array([[row[name] for name in names] for row in result])
                closest = [int(np.argmin(np.abs(result["time"] - t))) for t in times]
                errors["CVode"] = error(every[closest], expected)
                assert errors["CVode"] < 1e-5, f"{stem}, FMI {version}: {errors}"
            text = ", ".join(f"{name} {value:.1e}" for name, value in errors.items())
            print(f"{stem}, FMI {version}: {len(names)} variables, {events} events, {text}, "
                  f"directional derivatives {case.get('directions_worst', float('nan')):.1e}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
