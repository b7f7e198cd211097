% Runs every function of every mechanism of a list at the states of a file, and writes all numbers that they give.
1;

function numbers = flat(value)
  % Row by row; of a pose its position, then its rotation.
  numbers = [];
  if isstruct(value)
    names = fieldnames(value);
    for k = 1:numel(value)
      for i = 1:numel(names)
        numbers = [numbers; flat(value(k).(names{i}))];
      end
    end
  elseif ndims(value) == 3
    numbers = reshape(permute(value, [3, 2, 1]), [], 1);
  else
    numbers = reshape(value.', [], 1);
  end
end

addpath(pwd);
mechanisms = jsondecode(fileread('list.json'));
for k = 1:numel(mechanisms)
  mechanism = mechanisms(k);
  machine = feval(mechanism.file);
  file = fopen([mechanism.name, '.states']);
  numbers = reshape(fread(file, Inf, 'double'), [], mechanism.states);
  fclose(file);
  counts = cellfun(@(entry) entry{2}, mechanism.layout);
  names = cellfun(@(entry) entry{1}, mechanism.layout, 'UniformOutput', false);
  first = cumsum([1; counts(:)]);
  file = fopen([mechanism.name, '.matlab.results'], 'w');
  for f = 1:numel(mechanism.functions)
    called = mechanism.functions(f);
    for state = 1:min(mechanism.octave_states, mechanism.states)
      values = {};
      for a = 1:numel(called.takes)
        number = find(strcmp(names, called.takes{a}));
        given = numbers(first(number):first(number + 1) - 1, state);
        if strcmp(called.takes{a}, 'prescribed')
          given = reshape(given, 3, []).';
        end
        values{a} = given;
      end
      results = cell(1, called.parts);
      [results{:}] = machine.(called.matlab)(values{:});
      for r = 1:called.parts
        fwrite(file, flat(results{r}), 'double');
      end
    end
  end
  fclose(file);
end
