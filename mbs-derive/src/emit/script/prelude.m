function params = mbs_parameters(params, given)
% Known parameters, all of them finite.
names = fieldnames(given);
for i = 1:numel(names)
  name = names{i};
  if ~isfield(params, name)
    error('mbs:parameter', 'there is no parameter %s; there are %s', name, strjoin(fieldnames(params)', ', '));
  end
  value = given.(name);
  if ~isnumeric(value) || ~isequal(size(value), size(params.(name))) || ~all(isfinite(value(:)))
    error('mbs:parameter', 'parameter %s must be finite and of size %s', name, mat2str(size(params.(name))));
  end
  params.(name) = double(value);
end
end


function mbs_sized(name, value, count)
% As many numbers as a mechanism has.
if numel(value) ~= count
  error('mbs:size', '%s must have %d numbers, not %d', name, count, numel(value));
end
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
