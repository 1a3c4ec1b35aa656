function write_program(S, file, lower, upper)
% Writes an Opt object of MPT3, or YALMIP's matrices (yalmip2mpt), for lower <= theta <= upper as a problem file (JSON).
  list = @(v) ['[' regexprep(sprintf('%.17g, ', full(v)), ', $', '') ']'];
  rows = @(M) ['[' strjoin(cellfun(list, num2cell(M, 2)', 'UniformOutput', false), ', ') ']'];
  filled = @(M, m, n) [M; zeros(m - size(M, 1), n)];  % an empty matrix stands for zeros
  out = '';
  if isfield(S, 'G')  % YALMIP: the same under the names of Opt; variables stand before parameters in lb and ub
    n = size(S.G, 2); out = [', "out": ' list(S.requested_variables - 1)];
    if ~S.qp, S.Cf = S.H; S.H = []; S.F = []; if isfield(S, 'D'), S.F = S.D'; end, end
    S = struct('H', S.H, 'f', S.Cf, 'pF', S.F', 'A', S.G, 'b', S.W, 'pB', S.E, 'Ae', S.Aeq, 'be', S.beq, ...
               'pE', -S.Beq, 'lb', S.lb(1:n), 'ub', S.ub(1:n), 'Ath', S.bndA, 'bth', S.bndb);
  end
  n = max(size(S.A, 2), size(S.Ae, 2)); p = numel(lower); I = eye(n); m = size(S.Ae, 1);
  top = find(isfinite(S.ub)); bottom = find(isfinite(S.lb));
  A = [S.A; I(top, :); -I(bottom, :); S.Ae];
  b = [S.b(:); reshape(S.ub(top), [], 1); -reshape(S.lb(bottom), [], 1); S.be(:)];
  B = [S.pB; zeros(numel(top) + numel(bottom), p); S.pE];
  id = fopen(file, 'w'); if id < 0, error('%s: cannot be written', file); end
  fprintf(id, '{"H": %s, "f": %s, "F": %s,\n "A": %s, "b": %s, "B": %s,\n "eq_ids": %s, "lb": %s, "ub": %s', ...
          rows(filled(S.H, n, n)), list(S.f), rows(filled(S.pF, n, p)), rows(A), list(b), rows(B), ...
          list(size(A, 1) - (m:-1:1)), list(lower), list(upper));
  fprintf(id, ', "A_theta": %s, "b_theta": %s%s}\n', rows(S.Ath), list(S.bth), out); fclose(id);
end
