def mbs_doubles(name, value):
    """Real numbers as an array of doubles."""
    array = np.asarray(value)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{name} must be real numbers, not of type {array.dtype}")
    return array.astype(np.float64, copy=False)


def mbs_argument(name, value, *shape):
    """An array of doubles whose last axes are of this shape."""
    array = mbs_doubles(name, value)
    if array.ndim < len(shape) or array.shape[array.ndim - len(shape) :] != shape:
        raise ValueError(f"{name} must end in axes {shape}, not be of shape {array.shape}")
    return array


def mbs_parameter(name, value, *shape):
    """A finite parameter of this shape."""
    array = mbs_doubles(f"parameter {name}", value)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"parameter {name} must be finite and of shape {shape}, not {value}")
    return array


def mbs_filled(batch, shape, values):
    """Numbers as arrays of this shape behind the axes of the batch."""
    filled = np.empty((*batch, len(values)))
    for i, value in enumerate(values):
        filled[..., i] = value
    return filled.reshape((*batch, *shape))


def mbs_pose(batch, shape, values):
    """Positions and rotations: of each twelve numbers."""
    flat = mbs_filled(batch, (*shape, 12), values)
    return Pose(flat[..., :3], flat[..., 3:].reshape((*batch, *shape, 3, 3)))


def mbs_wrench(batch, shape, values):
    """Forces and moments: of each six numbers."""
    flat = mbs_filled(batch, (*shape, 6), values)
    return Wrench(flat[..., :3], flat[..., 3:])


def mbs_sin_cos(x):
    """Sine and cosine from +, - and * alone, the bits of mbs-runtime's `sin_cos_all`, which says where they are from."""
    # x = k pi/2 + y - e
    k = x * 0.6366197723675814 + 6755399441055744.0 - 6755399441055744.0
    r = x - k * 1.5707963267341256
    w = k * 6.077100506303966e-11
    h = r - w
    t = k * 2.0222662487959506e-21 - (r - h - w)
    y = h - t
    e = t - (h - y)
    z = y * y
    z2 = z * z
    z4 = z2 * z2
    p = -0.1666666666666663 + z * 0.00833333333332184 + z2 * (-0.00019841269829358541 + z * 2.7557313538526334e-6)
    p = p + z4 * (-2.5050734392422683e-8 + z * 1.5895433544930663e-10)
    q = 0.041666666666666595 + z * -0.001388888888887334 + z2 * (2.4801587288999616e-5 + z * -2.755731421606095e-7)
    q = q + z4 * (2.087570523233725e-9 + z * -1.1358739381498488e-11)
    half = 0.5 * z
    one = 1.0 - half
    sin = y - (e * one - z * y * p)
    cos = one + (1.0 - one - half + (z2 * q + y * e))
    is_odd = np.mod(k, 2.0) == 1.0
    sin, cos = np.where(is_odd, cos, sin), np.where(is_odd, sin, cos)
    sin = np.where(np.mod(k, 4.0) >= 2.0, -sin, sin)
    cos = np.where(np.mod(k + 1.0, 4.0) >= 2.0, -cos, cos)
    is_within = np.abs(x) <= 1e5
    if np.all(is_within):
        return sin, cos
    return np.where(is_within, sin, np.sin(x)), np.where(is_within, cos, np.cos(x))


def mbs_sin_cos_all(angles):
    """Sines and cosines of several angles, each a number or a batch of them."""
    return mbs_sin_cos(np.array(np.broadcast_arrays(*angles)))


def mbs_own_sin(x):
    """The sine alone."""
    return mbs_sin_cos(x)[0]


def mbs_own_cos(x):
    """The cosine alone."""
    return mbs_sin_cos(x)[1]


def mbs_signum(x):
    """-1, 0 or 1; NaN of NaN."""
    return np.where(x > 0.0, 1.0, np.where(x < 0.0, -1.0, x * 0.0))


def mbs_spline(places, rows, order, x):
    """A derivative of a piecewise polynomial: a row has its origin, then coefficients from the constant on."""
    row = rows[np.searchsorted(places, x, side="right")]
    s = x - row[..., 0]
    total = s * 0.0
    for power in range(rows.shape[1] - 2, order - 1, -1):
        total = math.prod(range(power + 1 - order, power + 1)) * row[..., 1 + power] + s * total
    return total


def mbs_ldlt(n, m):
    """M = L D L^T in place of the lower triangle of a list of rows; 1/D. No pivoting: M is positive definite."""
    reciprocals = []
    for k in range(n):
        reciprocals.append(np.float64(1.0) / m[k][k])
        column = [None if i <= k else m[i][k] * reciprocals[k] for i in range(n)]
        for i in range(k + 1, n):
            for j in range(k + 1, i + 1):
                m[i][j] = m[i][j] - m[i][k] * column[j]
        for i in range(k + 1, n):
            m[i][k] = column[i]
    return reciprocals


def mbs_ldlt_solve(n, columns, m, reciprocals, b):
    """X of M X = B in place of B, a list of rows of this many columns."""
    for c in range(columns):
        for k in range(n):
            for i in range(k + 1, n):
                b[i * columns + c] = b[i * columns + c] - m[i][k] * b[k * columns + c]
        for i in reversed(range(n)):
            x = b[i * columns + c] * reciprocals[i]
            for k in range(i + 1, n):
                x = x - m[k][i] * b[k * columns + c]
            b[i * columns + c] = x
    return b


def mbs_exponent(x):
    """The exponent of a number that is not zero; of a subnormal one that of the smallest normal one."""
    return None if x == 0.0 else max(math.frexp(x)[1] - 1, -1022)


def mbs_scaled(x, exponent):
    """A number times a power of two."""
    while abs(exponent) > 100:
        step = max(-100, min(100, exponent))
        x = x * math.ldexp(1.0, step)
        exponent -= step
    return x * math.ldexp(1.0, exponent)


def mbs_most(values):
    """The greatest of some numbers, those that are None left out; None of none."""
    return max((x for x in values if x is not None), default=None)


def mbs_largest(values):
    """The greatest magnitude."""
    largest = 0.0
    for x in values:
        largest = max(largest, abs(x))
    return largest


class mbs_Scales:
    """Exponents by which M and A are scaled, as mbs-runtime's `dynamics/scaling.rs` finds them."""

    def __init__(self, n, diagonal, a, vectors):
        self.n, self.k, self.vectors = n, len(a), vectors
        self.inertia = [mbs_exponent(x) for x in diagonal]
        self.slopes = [[mbs_exponent(x) for x in row] for row in a]
        self.taken = [None] * n
        self.forget_rounding()
        self.assign()
        self.mass = next((size for size in self.inertia if size is not None), 0)
        self.columns = [(size - self.mass) // 2 for size in self.sizes()]
        sizes = [self.row_sizes(row) for row in range(self.k)]
        self.small = [size - own for own, size in sizes]
        self.rows = [size for _, size in sizes]

    def vector(self, row):
        return [s for s, v in zip(self.slopes, self.vectors) if v == self.vectors[row]]

    def forget_rounding(self):
        for i in range(self.n):
            for row in range(self.k):
                beside = mbs_most(slopes[i] for slopes in self.vector(row))
                own = self.slopes[row][i]
                if own is not None and beside > own + 46:
                    self.slopes[row][i] = None

    def weight(self, row, i):
        slope, inertia = self.slopes[row][i], self.inertia[i]
        return None if slope is None else 2 * slope - (-(2**32) if inertia is None else inertia)

    def assign(self):
        n, taken = self.n, self.taken
        u, v = [0] * self.k, [0] * n
        for start in range(self.k):
            distance, before, visited = [math.inf] * n, [n] * n, [False] * n
            row, last, so_far, column = start, n, 0, None
            weights = [self.weight(start, i) for i in range(n)]
            u[start] = -(mbs_most(None if w is None else w + v[i] for i, w in enumerate(weights)) or 0)
            while True:
                for i in range(n):
                    own = self.weight(row, i)
                    if visited[i] or own is None:
                        continue
                    through = so_far - own - u[row] - v[i]
                    if through < distance[i]:
                        distance[i], before[i] = through, last
                near = min((i for i in range(n) if not visited[i]), key=lambda i: distance[i], default=None)
                if near is None or distance[near] == math.inf:
                    break
                visited[near], so_far, last = True, distance[near], near
                if taken[near] is None:
                    column = near
                    break
                row = taken[near]
            if column is None:
                continue
            for i in range(n):
                if visited[i] and i != column:
                    v[i] -= so_far - distance[i]
                    if taken[i] is not None:
                        u[taken[i]] += so_far - distance[i]
            u[start] += so_far
            while before[column] < n:
                taken[column] = taken[before[column]]
                column = before[column]
            taken[column] = start

    def sizes(self):
        sizes = list(self.inertia)
        self.raise_sizes(sizes)
        massless = [i for i in range(self.n) if self.taken[i] is not None and self.inertia[i] is None]
        for i in massless:
            sizes[i] = None
        self.relax(sizes, massless)
        while (i := next((i for i in massless if sizes[i] is None), None)) is not None:
            sizes[i] = self.lower_bound(sizes, i) or 0
            self.relax(sizes, massless)
        return [(self.lower_bound(sizes, i) or 0) if size is None else size for i, size in enumerate(sizes)]

    def raise_sizes(self, sizes):
        for _ in range(self.k + 1):
            changed = False
            for i in range(self.n):
                bound = None if self.taken[i] is None else self.lower_bound(sizes, i)
                if bound is not None and (sizes[i] is None or bound > sizes[i]):
                    sizes[i], changed = bound, True
            if not changed:
                return

    def relax(self, sizes, massless):
        for _ in range(self.k + 1):
            changed = False
            for i in massless:
                row = self.slopes[self.taken[i]]
                if row[i] is None:
                    continue
                known = (j for j in range(self.n) if j != i and row[j] is not None and sizes[j] is not None)
                least = min((2 * (row[i] - row[j]) + sizes[j] for j in known), default=None)
                if least is not None and (sizes[i] is None or least < sizes[i]):
                    sizes[i], changed = least, True
            if not changed:
                return

    def row_sizes(self, row):
        """Of the row, and of its vector in the coordinates that it moves."""
        greatest = []
        for i in range(self.n):
            most = mbs_most(slopes[i] for slopes in self.vector(row))
            greatest.append(None if most is None else most - self.columns[i])
        moved = [i for i in range(self.n) if self.slopes[row][i] is not None]
        own = mbs_most(self.slopes[row][i] - self.columns[i] for i in moved)
        size = mbs_most(greatest[i] for i in moved)
        size = mbs_most(greatest) if size is None else size
        size = 0 if size is None else size
        return (size - 46 if own is None else own), size

    def lower_bound(self, sizes, coordinate):
        bounds = []
        for i in range(self.n):
            if i != coordinate and self.taken[i] is not None and sizes[i] is not None:
                row = self.slopes[self.taken[i]]
                if row[coordinate] is not None and row[i] is not None:
                    bounds.append(sizes[i] + 2 * (row[coordinate] - row[i]))
        return mbs_most(bounds)


class mbs_NullSpace:
    """M q'' - A^T l = f, A q'' = c in a basis of the null space of A, as mbs-runtime's `dynamics/null_space.rs`."""

    def __init__(self, n, vectors, mass, jacobian):
        k = len(vectors)
        a = [jacobian[row * n : (row + 1) * n] for row in range(k)]
        triangle = [mass[i * n + j] for i in range(n) for j in range(i + 1)]
        self.n, self.k, self.vectors, self.rank = n, k, vectors, 0
        self.is_regular = all(map(math.isfinite, triangle)) and all(map(math.isfinite, jacobian))
        if not self.is_regular:
            return

        def m(i, j):
            return mass[max(i, j) * n + min(i, j)]

        self.scales = scales = mbs_Scales(n, [m(i, i) for i in range(n)], a, vectors)
        s, t = scales.columns, scales.rows
        self.mass = [[mbs_scaled(m(i, j), -s[i] - s[j] - scales.mass) for j in range(n)] for i in range(n)]
        self.slopes = [[mbs_scaled(x, -s[i] - t[row]) for i, x in enumerate(a[row])] for row in range(k)]
        self.basis = [list(row) for row in self.slopes]
        self.reciprocals = [0.0] * k
        self.rows, self.columns = list(range(k)), list(range(n))
        self.inertia = [[0.0] * n for _ in range(n)]
        self.compliance = [0.0] * n
        self.gram = [[0.0] * k for _ in range(k)]
        self.eliminate()
        self.solve_for_dependent_coordinates()
        self.is_regular = self.factorize(self.reduce())
        if self.is_regular:
            self.relate_redundant_rows()

    def eliminate(self):
        basis = self.basis
        while (pivot := self.pivot()) is not None:
            row, column = pivot
            p = self.rank
            basis[p], basis[row] = basis[row], basis[p]
            self.rows[p], self.rows[row] = self.rows[row], self.rows[p]
            for other in basis:
                other[p], other[column] = other[column], other[p]
            self.columns[p], self.columns[column] = self.columns[column], self.columns[p]
            pivots = basis[p]
            self.reciprocals[p] = 1.0 / pivots[p]
            for other in basis[p + 1 :]:
                other[p] = other[p] * self.reciprocals[p]
                for j in range(p + 1, self.n):
                    other[j] = other[j] - other[p] * pivots[j]
            self.rank += 1

    def pivot(self):
        n, basis = self.n, self.basis

        def size(entry):
            return abs(basis[entry[0]][entry[1]])

        entries = []
        for row in range(self.rank, self.k):
            own = [(row, i) for i in range(self.rank, n)]
            least = self.least_slope(self.rows[row])
            if any(least < size(entry) for entry in own):
                entries.extend(own)
        if not entries:
            return None
        largest = max(entries, key=size)
        enough = size(largest) * 0.5
        taken = [(row, i) for row, i in entries if self.scales.taken[self.columns[i]] == self.rows[row]]
        taken = [entry for entry in taken if not size(entry) < enough]
        return min(taken, key=self.growth, default=largest)

    def least_slope(self, row):
        least, small = 1.4901161193847656e-8 * 1e-2, self.scales.small[row]
        return least if small == 0 else max(mbs_scaled(least, -small), 16.0 * 2.0**-52)

    def growth(self, entry):
        row, column = entry
        others = [i for i in range(self.rank, self.n) if i != column]
        along = mbs_most(mbs_exponent(self.basis[row][i]) for i in others)
        rows = [k for k in range(self.rank, self.k) if k != row]
        across = mbs_most(mbs_exponent(self.basis[k][column]) for k in rows)
        own = mbs_exponent(self.basis[row][column])
        return -math.inf if along is None or across is None or own is None else along + across - own

    def solve_for_dependent_coordinates(self):
        basis = self.basis
        for p in reversed(range(self.rank)):
            for j in range(self.rank, self.n):
                rest = basis[p][j]
                for i in range(p + 1, self.rank):
                    rest = rest - basis[p][i] * basis[i][j]
                basis[p][j] = rest * self.reciprocals[p]

    def ordered_mass(self):
        return [[self.mass[i][j] for j in self.columns] for i in self.columns]

    def reduce(self):
        r, s, w, m = self.rank, self.n - self.rank, self.basis, self.ordered_mass()
        carried = [[m[p][r + j] for j in range(s)] for p in range(r)]
        for p in range(r):
            for j in range(s):
                for i in range(r):
                    carried[p][j] = carried[p][j] - m[p][i] * w[i][r + j]
        for i in range(s):
            for j in range(i + 1):
                total = m[r + i][r + j]
                for p in range(r):
                    total = total - m[r + i][p] * w[p][r + j]
                for p in range(r):
                    total = total - w[p][r + i] * carried[p][j]
                self.inertia[i][j] = total
        bounds = []
        for i in range(s):
            total = abs(m[r + i][r + i])
            for p in range(r):
                total = total + w[p][r + i] * w[p][r + i] * abs(m[p][p])
            bounds.append(total * (r + 1.0))
        return bounds

    def factorize(self, bounds):
        n, inertia = self.n, self.inertia
        s = n - self.rank
        weights = [1.0 / bound if bound else math.inf for bound in bounds]
        for p in range(s):
            pivot = p
            for i in range(p + 1, s):
                if inertia[pivot][pivot] * weights[pivot] < inertia[i][i] * weights[i]:
                    pivot = i
            if not 16.0 * n * 2.0**-52 < inertia[pivot][pivot] * weights[pivot]:
                return False
            self.exchange(p, pivot)
            weights[p], weights[pivot] = weights[pivot], weights[p]
            self.compliance[p] = 1.0 / inertia[p][p]
            column = [inertia[i][p] * self.compliance[p] for i in range(s)]
            for i in range(p + 1, s):
                u = inertia[i][p]
                for j in range(p + 1, i + 1):
                    inertia[i][j] = inertia[i][j] - u * column[j]
                inertia[i][p] = column[i]
        return True

    def exchange(self, p, i):
        if p == i:
            return
        r, inertia, columns = self.rank, self.inertia, self.columns

        def place(x, other):
            return (x, other) if other < p else (max(x, other), min(x, other))

        for other in range(self.n - r):
            if other not in (p, i):
                (a, b), (c, d) = place(p, other), place(i, other)
                inertia[a][b], inertia[c][d] = inertia[c][d], inertia[a][b]
        inertia[p][p], inertia[i][i] = inertia[i][i], inertia[p][p]
        columns[r + p], columns[r + i] = columns[r + i], columns[r + p]
        for row in self.basis:
            row[r + p], row[r + i] = row[r + i], row[r + p]

    def relate_redundant_rows(self):
        r, k, basis, gram = self.rank, self.k, self.basis, self.gram
        for row in range(r, k):
            for p in reversed(range(r)):
                for i in range(p + 1, r):
                    basis[row][p] = basis[row][p] - basis[row][i] * basis[i][p]
        for row in range(r, k):
            for other in range(r, row + 1):
                total = 1.0 if row == other else 0.0
                for p in range(r):
                    total = total + basis[row][p] * basis[other][p]
                for i in range(r, other):
                    total = total - gram[row][i] * gram[other][i] * gram[i][i]
                gram[row][other] = total if row == other else total / gram[other][other]

    def solve(self, columns, motion, sizes):
        """Of columns of f, then c; `motion` and `sizes` of slopes, else empty."""
        n, k = self.n, self.k
        none = [math.nan] * (n + k)
        if not self.is_regular or not all(map(math.isfinite, motion)):
            return [none for _ in columns]
        s, t, mass = self.scales.columns, self.scales.rows, self.scales.mass
        scaled = []
        for column in columns:
            force = [mbs_scaled(x, -s[i] - mass) for i, x in enumerate(column[:n])]
            scaled.append((force, [mbs_scaled(x, -t[row]) for row, x in enumerate(column[n:])]))
        greatest = [] if self.rank == k else self.greatest_sizes(scaled, motion, sizes)
        solutions = []
        for j, (force, target) in enumerate(scaled):
            q = self.motion(force, target)
            if self.rank < k:
                own = [abs(x) for x in target]
                scale = abs(sizes[j]) if sizes else 0.0
                if 0.0 < scale:
                    own = [max(size, most / scale) for size, most in zip(own, greatest)]
                if not self.agrees(q, target, own):
                    solutions.append(none)
                    continue
            solution = [mbs_scaled(x, -s[i]) for i, x in enumerate(q)]
            solution += [mbs_scaled(x, mass - t[row]) for row, x in enumerate(self.multipliers(q, force))]
            solutions.append(solution if all(map(math.isfinite, solution)) else none)
        return solutions

    def greatest_sizes(self, columns, motion, sizes):
        greatest = [0.0] * self.k
        if not motion:
            return greatest
        fastest = mbs_largest(mbs_scaled(x, self.scales.columns[i]) for i, x in enumerate(motion))
        for (force, target), size in zip(columns, sizes):
            scale = abs(size)
            most = mbs_largest(self.motion(force, target)) * scale
            fastest = max(fastest, most)
            for row, x in enumerate(target):
                most = abs(x) * scale
                greatest[row] = max(greatest[row], most)
        for row, slopes in enumerate(self.slopes):
            if 0.0 < mbs_largest(slopes) and greatest[row] < fastest:
                greatest[row] = fastest
        return greatest

    def motion(self, force, target):
        n, r, basis, inertia = self.n, self.rank, self.basis, self.inertia
        s, m, q = n - r, self.ordered_mass(), [0.0] * n
        for p in range(r):
            q[p] = target[self.rows[p]]
            for i in range(p):
                q[p] = q[p] - basis[p][i] * q[i]
        for p in reversed(range(r)):
            for i in range(p + 1, r):
                q[p] = q[p] - basis[p][i] * q[i]
            q[p] = q[p] * self.reciprocals[p]
        rest = [force[i] for i in self.columns]
        for i in range(n):
            for p in range(r):
                rest[i] = rest[i] - m[i][p] * q[p]
        for i in range(s):
            total = rest[r + i]
            for p in range(r):
                total = total - basis[p][r + i] * rest[p]
            for j in range(i):
                total = total - inertia[i][j] * q[r + j]
            q[r + i] = total
        for i in reversed(range(s)):
            total = q[r + i] * self.compliance[i]
            for j in range(i + 1, s):
                total = total - inertia[j][i] * q[r + j]
            q[r + i] = total
        for p in range(r):
            for i in range(r, n):
                q[p] = q[p] - basis[p][i] * q[i]
        ordered = list(q)
        for i, x in zip(self.columns, q):
            ordered[i] = x
        return ordered

    def size(self, row, motion, sizes):
        def terms(other):
            total = 0.0
            for a, x in zip(self.slopes[other], motion):
                total = total + abs(a) * abs(x)
            return sizes[other] + total

        size = terms(row)
        if mbs_largest(self.slopes[row]) < 1.0:
            t = self.scales.rows
            for other in range(self.k):
                if other != row and self.vectors[other] == self.vectors[row]:
                    size = max(size, mbs_scaled(terms(other), t[other] - t[row]))
        return size

    def agrees(self, motion, target, sizes):
        for k in range(self.rank, self.k):
            row = self.rows[k]
            rest, size = target[row], self.size(row, motion, sizes)
            for p in range(self.rank):
                factor = self.basis[k][p]
                rest = rest - factor * target[self.rows[p]]
                size = size + abs(factor) * self.size(self.rows[p], motion, sizes)
            allowed = size * 1.4901161193847656e-8
            for i in range(self.rank, self.n):
                allowed = allowed + abs(self.basis[k][i]) * abs(motion[self.columns[i]])
            if not (abs(rest) < allowed or rest == 0.0):
                return False
        return True

    def multipliers(self, motion, force):
        n, k, r, basis, gram = self.n, self.k, self.rank, self.basis, self.gram
        forces = [0.0] * k
        for p in range(r):
            i = self.columns[p]
            total = -force[i]
            for j in range(n):
                total = total + self.mass[i][j] * motion[j]
            for q in range(p):
                total = total - basis[q][p] * forces[q]
            forces[p] = total * self.reciprocals[p]
        for p in reversed(range(r)):
            for row in range(p + 1, r):
                forces[p] = forces[p] - basis[row][p] * forces[row]
        for row in range(r, k):
            total = 0.0
            for p in range(r):
                total = total + basis[row][p] * forces[p]
            for i in range(r, row):
                total = total - gram[row][i] * forces[i]
            forces[row] = total
        for row in reversed(range(r, k)):
            total = forces[row] / gram[row][row]
            for i in range(row + 1, k):
                total = total - gram[i][row] * forces[i]
            forces[row] = total
        for p in range(r):
            for row in range(r, k):
                forces[p] = forces[p] - basis[row][p] * forces[row]
        ordered = list(forces)
        for row, x in zip(self.rows, forces):
            ordered[row] = x
        return ordered


def mbs_constrained(n, vectors, values, widths, motion, sizes):
    """Motion, or its derivatives, of every state of a batch: M, A, then right sides part by part, row by row."""
    k = len(vectors)
    solutions = []
    batch = values.shape[:-1]
    motions = motion.reshape((-1, n)) if sizes is not None else np.zeros((math.prod(batch), 0))
    columns_of = sizes.reshape((-1, sum(widths))) if sizes is not None else motions
    flat = values.reshape((-1, values.shape[-1])).tolist()
    for state, own_motion, own_sizes in zip(flat, motions.tolist(), columns_of.tolist()):
        system = mbs_NullSpace(n, vectors, state[: n * n], state[n * n : (n + k) * n])
        right_side, columns = state[(n + k) * n :], []
        for width in widths:
            part, right_side = right_side[: (n + k) * width], right_side[(n + k) * width :]
            columns.extend(part[column::width] for column in range(width))
        solutions.append(system.solve(columns, own_motion, own_sizes))
    return np.array(solutions).reshape((*batch, sum(widths), n + k)).swapaxes(-1, -2)


def mbs_state_sizes(batch, q, qd, kinds, inputs):
    """How large coordinates, speeds and inputs are by which accelerations are differentiated."""

    def largest(values, kind):
        alike = [abs(values[..., i]) for i, other in enumerate(kinds) if other == kind]
        most = alike[0] * 0.0
        for x in alike:
            most = np.where(most < x, x, most)
        return most

    places = [1.0 if kind == 0 else largest(q, kind) for kind in kinds]
    rates = [largest(qd, kind) for kind in kinds]
    return mbs_filled(batch, (2 * len(kinds) + inputs,), [*places, *rates, *[0.0] * inputs])
