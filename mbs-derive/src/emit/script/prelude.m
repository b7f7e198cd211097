function params = mbs_parameters(params, given)
% Known parameters, all of them finite.
names = fieldnames(given);
for i = 1:numel(names)
  name = names{i};
  if ~isfield(params, name)
    error('mbs:parameter', 'there is no parameter %s; there are %s', name, strjoin(fieldnames(params)', ', '));
  end
  value = given.(name);
  if isvector(value) && isvector(params.(name)) && numel(value) == numel(params.(name))
    value = reshape(value, size(params.(name)));
  end
  if ~isnumeric(value) || ~isreal(value) || ~isequal(size(value), size(params.(name))) || ~all(isfinite(value(:)))
    error('mbs:parameter', 'parameter %s must be real, finite and of size %s', name, mat2str(size(params.(name))));
  end
  params.(name) = double(value);
end
end


function value = mbs_sized(name, value, count)
% As many real numbers as a mechanism has, as doubles.
if numel(value) ~= count
  error('mbs:size', '%s must have %d numbers, not %d', name, count, numel(value));
end
if ~isnumeric(value) || ~isreal(value)
  error('mbs:real', '%s must be real numbers', name);
end
value = double(value);
end


function value = mbs_signals(name, value, count)
% Of each signal a row: its value, rate and second derivative.
if ~isequal(size(value), [count, 3])
  error('mbs:size', '%s must have a row of value, rate and second derivative for each of %d, not the size %s', ...
    name, count, mat2str(size(value)));
end
value = mbs_sized(name, value, 3 * count);
end


function [sine, cosine] = mbs_sin_cos(x)
% From +, - and * alone, the same bits as mbs-runtime's sin_cos_all, which says where they are from.
if ~(abs(x) <= 1e5)
  sine = sin(x);
  cosine = cos(x);
  return
end
% x = k pi/2 + y - e
k = x * 0.6366197723675814 + 6755399441055744.0 - 6755399441055744.0;
r = x - k * 1.5707963267341256;
w = k * 6.077100506303966e-11;
h = r - w;
t = k * 2.0222662487959506e-21 - (r - h - w);
y = h - t;
e = t - (h - y);
z = y * y;
z2 = z * z;
z4 = z2 * z2;
p = -0.1666666666666663 + z * 0.00833333333332184 + z2 * (-0.00019841269829358541 + z * 2.7557313538526334e-6);
p = p + z4 * (-2.5050734392422683e-8 + z * 1.5895433544930663e-10);
q = 0.041666666666666595 + z * -0.001388888888887334 + z2 * (2.4801587288999616e-5 + z * -2.755731421606095e-7);
q = q + z4 * (2.087570523233725e-9 + z * -1.1358739381498488e-11);
half = 0.5 * z;
one = 1.0 - half;
s = y - (e * one - z * y * p);
c = one + (1.0 - one - half + (z2 * q + y * e));
switch mod(k, 4)
  case 0
    sine = s;
    cosine = c;
  case 1
    sine = c;
    cosine = -s;
  case 2
    sine = -s;
    cosine = -c;
  otherwise
    sine = -c;
    cosine = s;
end
end


function [sines, cosines] = mbs_sin_cos_all(angles)
% Sines and cosines of several angles.
sines = angles;
cosines = angles;
for i = 1:numel(angles)
  [sines(i), cosines(i)] = mbs_sin_cos(angles(i));
end
end


function y = mbs_own_sin(x)
[y, ~] = mbs_sin_cos(x);
end


function y = mbs_own_cos(x)
[~, y] = mbs_sin_cos(x);
end


function y = mbs_choose(condition, a, b)
if condition
  y = a;
else
  y = b;
end
end


function y = mbs_real(f, x, is_defined)
% NaN where a function has no real value.
if is_defined
  y = f(x);
else
  y = NaN;
end
end


function y = mbs_sqrt(x)
y = mbs_real(@sqrt, x, x >= 0.0);
end


function y = mbs_ln(x)
y = mbs_real(@log, x, x >= 0.0);
end


function y = mbs_asin(x)
y = mbs_real(@asin, x, abs(x) <= 1.0);
end


function y = mbs_acos(x)
y = mbs_real(@acos, x, abs(x) <= 1.0);
end


function y = mbs_powf(x, exponent)
y = mbs_real(@(x) x^exponent, x, x >= 0.0 || exponent == fix(exponent));
end


function y = mbs_signum(x)
% -1, 0 or 1; NaN of NaN.
if x > 0.0
  y = 1.0;
elseif x < 0.0
  y = -1.0;
else
  y = x * 0.0;
end
end


function total = mbs_spline(places, rows, order, x)
% A derivative of a piecewise polynomial: a row has its origin, then coefficients from the constant on.
first = 0;
last = numel(places);
while first < last
  middle = first + floor((last - first) / 2);
  if x < places(middle + 1)
    last = middle;
  else
    first = middle + 1;
  end
end
row = rows(first + 1, :);
s = x - row(1);
total = s * 0.0;
for power = numel(row) - 2:-1:order
  total = prod(power + 1 - order:power) * row(2 + power) + s * total;
end
end


function [m, reciprocals] = mbs_ldlt(m)
% M = L D L^T in place of the lower triangle; 1/D. No pivoting: M is positive definite.
n = size(m, 1);
reciprocals = zeros(n, 1);
for k = 1:n
  reciprocals(k) = 1.0 / m(k, k);
  column = m(:, k) * reciprocals(k);
  for i = k + 1:n
    m(i, k + 1:i) = m(i, k + 1:i) - m(i, k) * column(k + 1:i)';
  end
  m(k + 1:n, k) = column(k + 1:n);
end
end


function b = mbs_ldlt_solve(m, reciprocals, b)
% X of M X = B.
n = size(m, 1);
for k = 1:n
  for i = k + 1:n
    b(i, :) = b(i, :) - m(i, k) * b(k, :);
  end
end
for i = n:-1:1
  b(i, :) = b(i, :) * reciprocals(i);
  for k = i + 1:n
    b(i, :) = b(i, :) - m(k, i) * b(k, :);
  end
end
end
