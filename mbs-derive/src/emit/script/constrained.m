function e = mbs_exponent(x)
% The exponent of a number that is not zero, else -Inf; of a subnormal one that of the smallest normal one.
if x == 0.0
  e = -Inf;
else
  [~, e] = log2(abs(x));
  e = max(e - 1, -1022);
end
end


function x = mbs_scaled(x, exponent)
% A number times a power of two.
while abs(exponent) > 100
  step = max(-100, min(100, exponent));
  x = x * 2.0^step;
  exponent = exponent - step;
end
x = x * 2.0^exponent;
end


function largest = mbs_largest(values)
% The greatest magnitude, 0 of none.
largest = max([0.0; abs(values(:))]);
end


function bound = mbs_lower_bound(f, sizes, coordinate)
bound = -Inf;
for i = 1:numel(sizes)
  if i ~= coordinate && f.taken(i) > 0 && sizes(i) > -Inf
    row = f.slopes(f.taken(i), :);
    if row(coordinate) > -Inf && row(i) > -Inf
      bound = max(bound, sizes(i) + 2 * (row(coordinate) - row(i)));
    end
  end
end
end


function sizes = mbs_relax(f, sizes, massless)
for round = 0:size(f.slopes, 1)
  changed = false;
  for i = massless
    row = f.slopes(f.taken(i), :);
    if row(i) == -Inf
      continue
    end
    least = Inf;
    for j = 1:numel(sizes)
      if j ~= i && row(j) > -Inf && sizes(j) > -Inf
        least = min(least, 2 * (row(i) - row(j)) + sizes(j));
      end
    end
    if least < Inf && (sizes(i) == -Inf || least < sizes(i))
      sizes(i) = least;
      changed = true;
    end
  end
  if ~changed
    return
  end
end
end


function w = mbs_weight(f, row, i)
% Of an entry that is not zero.
inertia = f.inertia(i);
if inertia == -Inf
  inertia = -2.0^32;
end
w = 2 * f.slopes(row, i) - inertia;
end


function taken = mbs_assign(f)
% The row that takes each coordinate, by the Hungarian method.
[k, n] = size(f.slopes);
taken = zeros(1, n);
u = zeros(1, k);
v = zeros(1, n);
for start = 1:k
  distance = Inf(1, n);
  before = zeros(1, n);
  visited = false(1, n);
  row = start;
  last = 0;
  so_far = 0;
  column = 0;
  most = -Inf;
  for i = 1:n
    if f.slopes(start, i) > -Inf
      most = max(most, mbs_weight(f, start, i) + v(i));
    end
  end
  if most > -Inf
    u(start) = -most;
  end
  while true
    near = 0;
    for i = 1:n
      if visited(i)
        continue
      end
      if f.slopes(row, i) > -Inf
        through = so_far - mbs_weight(f, row, i) - u(row) - v(i);
        if through < distance(i)
          distance(i) = through;
          before(i) = last;
        end
      end
      if near == 0 || distance(i) < distance(near)
        near = i;
      end
    end
    if near == 0 || distance(near) == Inf
      break
    end
    visited(near) = true;
    so_far = distance(near);
    last = near;
    if taken(near) == 0
      column = near;
      break
    end
    row = taken(near);
  end
  if column == 0
    continue
  end
  for i = 1:n
    if visited(i) && i ~= column
      v(i) = v(i) - (so_far - distance(i));
      if taken(i) > 0
        u(taken(i)) = u(taken(i)) + so_far - distance(i);
      end
    end
  end
  u(start) = u(start) + so_far;
  while before(column) > 0
    taken(column) = taken(before(column));
    column = before(column);
  end
  taken(column) = start;
end
end


function sizes = mbs_sizes(f)
[k, n] = size(f.slopes);
sizes = f.inertia;
for round = 0:k
  changed = false;
  for i = find(f.taken > 0)
    bound = mbs_lower_bound(f, sizes, i);
    if bound > sizes(i)
      sizes(i) = bound;
      changed = true;
    end
  end
  if ~changed
    break
  end
end
massless = find(f.taken > 0 & f.inertia == -Inf);
sizes(massless) = -Inf;
sizes = mbs_relax(f, sizes, massless);
while any(sizes(massless) == -Inf)
  i = massless(find(sizes(massless) == -Inf, 1));
  sizes(i) = mbs_lower_bound(f, sizes, i);
  if sizes(i) == -Inf
    sizes(i) = 0;
  end
  sizes = mbs_relax(f, sizes, massless);
end
given = sizes;
for i = 1:n
  if sizes(i) == -Inf
    bound = mbs_lower_bound(f, given, i);
    given_here = bound;
    if bound == -Inf
      given_here = 0;
    end
    sizes(i) = given_here;
  end
end
end


function f = mbs_scales(diagonal, a, vectors)
% Exponents by which M and A are scaled, as mbs-runtime's dynamics/scaling.rs finds them; -Inf of a zero.
[k, n] = size(a);
f.inertia = arrayfun(@mbs_exponent, reshape(diagonal, 1, n));
f.slopes = reshape(arrayfun(@mbs_exponent, a), k, n);
for i = 1:n
  for row = 1:k
    if max(f.slopes(vectors == vectors(row), i)) > f.slopes(row, i) + 46
      f.slopes(row, i) = -Inf;
    end
  end
end
f.taken = mbs_assign(f);
f.mass = 0;
known = f.inertia(f.inertia > -Inf);
if ~isempty(known)
  f.mass = known(1);
end
f.columns = floor((mbs_sizes(f) - f.mass) / 2);
f.small = zeros(1, k);
f.rows = zeros(1, k);
for row = 1:k
  % Of the row, and of its vector in the coordinates that it moves.
  greatest = max(f.slopes(vectors == vectors(row), :), [], 1) - f.columns;
  moved = f.slopes(row, :) > -Inf;
  own = max([-Inf, f.slopes(row, moved) - f.columns(moved)]);
  most = max([-Inf, greatest(moved)]);
  if most == -Inf
    most = max([-Inf, greatest]);
  end
  if most == -Inf
    most = 0;
  end
  if own == -Inf
    own = most - 46;
  end
  f.small(row) = most - own;
  f.rows(row) = most;
end
end


function g = mbs_growth(s, row, column)
others = [s.rank + 1:column - 1, column + 1:s.n];
along = max([-Inf, arrayfun(@mbs_exponent, s.basis(row, others))]);
rows = [s.rank + 1:row - 1, row + 1:s.k];
across = max([-Inf, arrayfun(@mbs_exponent, reshape(s.basis(rows, column), 1, numel(rows)))]);
own = mbs_exponent(s.basis(row, column));
if along == -Inf || across == -Inf || own == -Inf
  g = -Inf;
else
  g = along + across - own;
end
end


function [row, column] = mbs_pivot(s)
row = 0;
column = 0;
largest = -1.0;
independent = [];
for k = s.rank + 1:s.k
  small = s.scales.small(s.rows(k));
  least = 1.4901161193847656e-8 * 1e-2;
  if small ~= 0
    least = max(mbs_scaled(least, -small), 16.0 * 2.0^-52);
  end
  if ~any(least < abs(s.basis(k, s.rank + 1:s.n)))
    continue
  end
  independent(end + 1) = k;
  for i = s.rank + 1:s.n
    if largest < abs(s.basis(k, i))
      largest = abs(s.basis(k, i));
      row = k;
      column = i;
    end
  end
end
enough = largest * 0.5;
gentlest = NaN;
for k = independent
  for i = s.rank + 1:s.n
    if s.scales.taken(s.columns(i)) ~= s.rows(k) || abs(s.basis(k, i)) < enough
      continue
    end
    growth = mbs_growth(s, k, i);
    if isnan(gentlest) || growth < gentlest
      gentlest = growth;
      row = k;
      column = i;
    end
  end
end
end


function s = mbs_null_space(vectors, mass, jacobian)
% M q'' - A^T l = f, A q'' = c in a basis of the null space of A, as mbs-runtime's dynamics/null_space.rs.
[k, n] = size(jacobian);
mass = tril(mass) + tril(mass, -1)';
s.n = n;
s.k = k;
s.rank = 0;
s.vectors = vectors;
s.is_regular = all(isfinite(mass(:))) && all(isfinite(jacobian(:)));
if ~s.is_regular
  return
end
s.scales = mbs_scales(diag(mass), jacobian, vectors);
s.mass = mass;
s.basis = jacobian;
for i = 1:n
  for j = 1:n
    s.mass(i, j) = mbs_scaled(mass(i, j), -s.scales.columns(i) - s.scales.columns(j) - s.scales.mass);
  end
  for row = 1:k
    s.basis(row, i) = mbs_scaled(jacobian(row, i), -s.scales.columns(i) - s.scales.rows(row));
  end
end
s.slopes = s.basis;
s.reciprocals = zeros(1, k);
s.rows = 1:k;
s.columns = 1:n;
s.inertia = zeros(n);
s.compliance = zeros(1, n);
s.gram = zeros(k);
[row, column] = mbs_pivot(s);
while row > 0
  p = s.rank + 1;
  s.basis([p, row], :) = s.basis([row, p], :);
  s.rows([p, row]) = s.rows([row, p]);
  s.basis(:, [p, column]) = s.basis(:, [column, p]);
  s.columns([p, column]) = s.columns([column, p]);
  s.reciprocals(p) = 1.0 / s.basis(p, p);
  for other = p + 1:k
    s.basis(other, p) = s.basis(other, p) * s.reciprocals(p);
    s.basis(other, p + 1:n) = s.basis(other, p + 1:n) - s.basis(other, p) * s.basis(p, p + 1:n);
  end
  s.rank = p;
  [row, column] = mbs_pivot(s);
end
r = s.rank;
for p = r:-1:1
  for i = p + 1:r
    s.basis(p, r + 1:n) = s.basis(p, r + 1:n) - s.basis(p, i) * s.basis(i, r + 1:n);
  end
  s.basis(p, r + 1:n) = s.basis(p, r + 1:n) * s.reciprocals(p);
end
[s, bounds] = mbs_reduce(s);
s = mbs_factorize(s, bounds);
if s.is_regular
  s = mbs_relate_redundant_rows(s);
end
end


function [s, bounds] = mbs_reduce(s)
r = s.rank;
count = s.n - r;
m = s.mass(s.columns, s.columns);
w = s.basis;
carried = m(1:r, r + 1:end);
for i = 1:r
  for p = 1:r
    carried(p, :) = carried(p, :) - m(p, i) * w(i, r + 1:end);
  end
end
bounds = zeros(1, count);
for i = 1:count
  for j = 1:i
    total = m(r + i, r + j);
    for p = 1:r
      total = total - m(r + i, p) * w(p, r + j);
    end
    for p = 1:r
      total = total - w(p, r + i) * carried(p, j);
    end
    s.inertia(i, j) = total;
  end
  total = abs(m(r + i, r + i));
  for p = 1:r
    total = total + w(p, r + i) * w(p, r + i) * abs(m(p, p));
  end
  bounds(i) = total * (r + 1.0);
end
end


function s = mbs_factorize(s, bounds)
r = s.rank;
count = s.n - r;
weights = 1.0 ./ bounds;
for p = 1:count
  pivot = p;
  for i = p + 1:count
    if s.inertia(pivot, pivot) * weights(pivot) < s.inertia(i, i) * weights(i)
      pivot = i;
    end
  end
  if ~(16.0 * s.n * 2.0^-52 < s.inertia(pivot, pivot) * weights(pivot))
    s.is_regular = false;
    return
  end
  s = mbs_exchange(s, p, pivot);
  weights([p, pivot]) = weights([pivot, p]);
  s.compliance(p) = 1.0 / s.inertia(p, p);
  column = s.inertia(:, p) * s.compliance(p);
  for i = p + 1:count
    s.inertia(i, p + 1:i) = s.inertia(i, p + 1:i) - s.inertia(i, p) * column(p + 1:i)';
  end
  s.inertia(p + 1:count, p) = column(p + 1:count);
end
end


function s = mbs_exchange(s, p, i)
if p == i
  return
end
r = s.rank;
for other = 1:s.n - r
  if other == p || other == i
    continue
  end
  if other < p
    a = [p, other];
    b = [i, other];
  else
    a = [max(p, other), min(p, other)];
    b = [max(i, other), min(i, other)];
  end
  first = s.inertia(a(1), a(2));
  s.inertia(a(1), a(2)) = s.inertia(b(1), b(2));
  s.inertia(b(1), b(2)) = first;
end
first = s.inertia(p, p);
s.inertia(p, p) = s.inertia(i, i);
s.inertia(i, i) = first;
s.columns([r + p, r + i]) = s.columns([r + i, r + p]);
s.basis(:, [r + p, r + i]) = s.basis(:, [r + i, r + p]);
end


function s = mbs_relate_redundant_rows(s)
r = s.rank;
for row = r + 1:s.k
  for p = r:-1:1
    for i = p + 1:r
      s.basis(row, p) = s.basis(row, p) - s.basis(row, i) * s.basis(i, p);
    end
  end
end
for row = r + 1:s.k
  for other = r + 1:row
    total = double(row == other);
    for p = 1:r
      total = total + s.basis(row, p) * s.basis(other, p);
    end
    for i = r + 1:other - 1
      total = total - s.gram(row, i) * s.gram(other, i) * s.gram(i, i);
    end
    if row ~= other
      total = total / s.gram(other, other);
    end
    s.gram(row, other) = total;
  end
end
end


function ordered = mbs_motion(s, force, target)
r = s.rank;
n = s.n;
count = n - r;
m = s.mass(s.columns, s.columns);
q = zeros(n, 1);
for p = 1:r
  q(p) = target(s.rows(p));
  for i = 1:p - 1
    q(p) = q(p) - s.basis(p, i) * q(i);
  end
end
for p = r:-1:1
  for i = p + 1:r
    q(p) = q(p) - s.basis(p, i) * q(i);
  end
  q(p) = q(p) * s.reciprocals(p);
end
rest = reshape(force(s.columns), n, 1);
for p = 1:r
  rest = rest - m(:, p) * q(p);
end
for i = 1:count
  total = rest(r + i);
  for p = 1:r
    total = total - s.basis(p, r + i) * rest(p);
  end
  for j = 1:i - 1
    total = total - s.inertia(i, j) * q(r + j);
  end
  q(r + i) = total;
end
for i = count:-1:1
  total = q(r + i) * s.compliance(i);
  for j = i + 1:count
    total = total - s.inertia(j, i) * q(r + j);
  end
  q(r + i) = total;
end
for i = r + 1:n
  q(1:r) = q(1:r) - s.basis(1:r, i) * q(i);
end
ordered = q;
ordered(s.columns) = q;
end


function size = mbs_size(s, row, motion, sizes)
terms = sizes;
for other = 1:s.k
  total = 0.0;
  for i = 1:s.n
    total = total + abs(s.slopes(other, i)) * abs(motion(i));
  end
  terms(other) = sizes(other) + total;
end
size = terms(row);
if mbs_largest(s.slopes(row, :)) < 1.0
  for other = find(s.vectors == s.vectors(row))
    if other ~= row
      size = max(size, mbs_scaled(terms(other), s.scales.rows(other) - s.scales.rows(row)));
    end
  end
end
end


function does = mbs_agrees(s, motion, target, sizes)
does = true;
for k = s.rank + 1:s.k
  row = s.rows(k);
  rest = target(row);
  size = mbs_size(s, row, motion, sizes);
  for p = 1:s.rank
    factor = s.basis(k, p);
    rest = rest - factor * target(s.rows(p));
    size = size + abs(factor) * mbs_size(s, s.rows(p), motion, sizes);
  end
  allowed = size * 1.4901161193847656e-8;
  for i = s.rank + 1:s.n
    allowed = allowed + abs(s.basis(k, i)) * abs(motion(s.columns(i)));
  end
  if ~(abs(rest) < allowed || rest == 0.0)
    does = false;
    return
  end
end
end


function ordered = mbs_multipliers(s, motion, force)
r = s.rank;
l = zeros(s.k, 1);
for p = 1:r
  i = s.columns(p);
  total = -force(i);
  for j = 1:s.n
    total = total + s.mass(i, j) * motion(j);
  end
  for q = 1:p - 1
    total = total - s.basis(q, p) * l(q);
  end
  l(p) = total * s.reciprocals(p);
end
for p = r:-1:1
  for row = p + 1:r
    l(p) = l(p) - s.basis(row, p) * l(row);
  end
end
for row = r + 1:s.k
  total = 0.0;
  for p = 1:r
    total = total + s.basis(row, p) * l(p);
  end
  for i = r + 1:row - 1
    total = total - s.gram(row, i) * l(i);
  end
  l(row) = total;
end
for row = s.k:-1:r + 1
  total = l(row) / s.gram(row, row);
  for i = row + 1:s.k
    total = total - s.gram(i, row) * l(i);
  end
  l(row) = total;
end
for p = 1:r
  for row = r + 1:s.k
    l(p) = l(p) - s.basis(row, p) * l(row);
  end
end
ordered = l;
ordered(s.rows) = l;
end


function solutions = mbs_solve(s, columns, motion, sizes)
% Of columns of f, then c; motion and sizes of slopes, else empty. NaN where there is no solution.
count = size(columns, 2);
solutions = NaN(size(columns));
if ~s.is_regular || ~all(isfinite(motion(:)))
  return
end
n = s.n;
k = s.k;
t = s.scales;
for j = 1:count
  for i = 1:n
    columns(i, j) = mbs_scaled(columns(i, j), -t.columns(i) - t.mass);
  end
  for row = 1:k
    columns(n + row, j) = mbs_scaled(columns(n + row, j), -t.rows(row));
  end
end
greatest = zeros(k, 1);
if s.rank < k && ~isempty(motion)
  fastest = 0.0;
  for i = 1:n
    fastest = max(fastest, abs(mbs_scaled(motion(i), t.columns(i))));
  end
  for j = 1:count
    scale = abs(sizes(j));
    q = mbs_motion(s, columns(1:n, j), columns(n + 1:n + k, j));
    fastest = max(fastest, mbs_largest(q) * scale);
    greatest = max(greatest, abs(columns(n + 1:n + k, j)) * scale);
  end
  for row = 1:k
    if 0.0 < mbs_largest(s.slopes(row, :))
      greatest(row) = max(greatest(row), fastest);
    end
  end
end
for j = 1:count
  force = columns(1:n, j);
  target = columns(n + 1:n + k, j);
  q = mbs_motion(s, force, target);
  if s.rank < k
    own = abs(target);
    if ~isempty(sizes) && 0.0 < abs(sizes(j))
      own = max(own, greatest / abs(sizes(j)));
    end
    if ~mbs_agrees(s, q, target, own)
      continue
    end
  end
  l = mbs_multipliers(s, q, force);
  for i = 1:n
    q(i) = mbs_scaled(q(i), -t.columns(i));
  end
  for row = 1:k
    l(row) = mbs_scaled(l(row), t.mass - t.rows(row));
  end
  if all(isfinite(q)) && all(isfinite(l))
    solutions(:, j) = [q; l];
  end
end
end


function sizes = mbs_state_sizes(q, qd, kinds, inputs)
% How large coordinates, speeds and inputs are by which accelerations are differentiated.
n = numel(kinds);
sizes = zeros(2 * n + inputs, 1);
for i = 1:n
  alike = kinds == kinds(i);
  sizes(i) = mbs_largest(q(alike));
  if kinds(i) == 0
    sizes(i) = 1.0;
  end
  sizes(n + i) = mbs_largest(qd(alike));
end
end
