function write_program(S, file, lower, upper)
% WRITE_PROGRAM  Writes a multiparametric program as a problem file of Polyfly (JSON), under MATLAB or Octave.
%   S is an Opt object of MPT3, or the matrices of YALMIP (yalmip2mpt). The parameters range from `lower` to `upper`.
  list = @(v) ['[' strjoin(arrayfun(@(x) sprintf('%.17g', x), full(v(:)'), 'UniformOutput', false), ', ') ']'];
  rows = @(M) ['[' strjoin(cellfun(list, num2cell(full(M), 2)', 'UniformOutput', false), ', ') ']'];
  out = '';
  if isfield(S, 'G')  % YALMIP: the same under the names of Opt; variables stand before parameters in lb and ub
    n = size(S.G, 2); out = [', "out": ' list(S.requested_variables - 1)];
    P = struct('H', S.H, 'f', S.Cf, 'pF', S.F', 'A', S.G, 'b', S.W, 'pB', S.E, 'Ae', S.Aeq, 'be', S.beq, ...
               'pE', -S.Beq, 'lb', S.lb(1:n), 'ub', S.ub(1:n), 'Ath', S.bndA, 'bth', S.bndb);
    if ~S.qp, P.H = []; P.f = S.H; P.pF = []; if isfield(S, 'D'), P.pF = S.D; end, end
    S = P;
  end
  n = max(size(S.A, 2), size(S.Ae, 2)); p = numel(lower); I = eye(n); H = S.H; F = S.pF;
  if isempty(H), H = zeros(n); end
  if isempty(F), F = zeros(n, p); end
  top = find(isfinite(S.ub)); bottom = find(isfinite(S.lb));
  A = [S.A; I(top, :); -I(bottom, :); S.Ae];
  b = [S.b(:); reshape(S.ub(top), [], 1); -reshape(S.lb(bottom), [], 1); S.be(:)];
  B = [S.pB; zeros(numel(top) + numel(bottom), p); S.pE];
  equal = size(A, 1) - size(S.Ae, 1):size(A, 1) - 1;
  id = fopen(file, 'w');
  if id < 0, error('%s: cannot be written', file); end
  fprintf(id, '{"H": %s, "f": %s, "F": %s,\n "A": %s, "b": %s, "B": %s,\n', rows(H), list(S.f), rows(F), rows(A), list(b), rows(B));
  fprintf(id, ' "eq_ids": %s, "lb": %s, "ub": %s, "A_theta": %s, "b_theta": %s%s}\n', ...
          list(equal), list(lower), list(upper), rows(S.Ath), list(S.bth), out);
  fclose(id);
end
