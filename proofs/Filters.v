(** * The filters stay in their box

    The paper's cascade (7) with its input held, and Theorem 1's thrust interval,
    in exact arithmetic; controller-core/src/position.rs. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

(** One axis of a step of the code: a to s and u-bar, b to u-bar. *)
Definition filtered_next (to_intermediate to_input u_f u_s ubar : R) : R :=
  u_f + (to_intermediate * (u_s - u_f) + to_input * (ubar - u_f)).
Definition intermediate_next (to_input u_s ubar : R) : R := u_s + to_input * (ubar - u_s).

Theorem box_is_kept : forall M a b c u_f u_s ubar,
  0 <= a -> 0 <= b -> a + b <= 1 -> 0 <= c <= 1 ->
  - M <= u_f <= M -> - M <= u_s <= M -> - M <= ubar <= M ->
  - M <= filtered_next a b u_f u_s ubar <= M /\ - M <= intermediate_next c u_s ubar <= M.
Proof.
  intros M a b c u_f u_s ubar Ha Hb Hab Hc Hf Hs Hu.
  unfold filtered_next, intermediate_next.
  assert (Hmix : forall k v, 0 <= k -> - M <= v <= M -> - (k * M) <= k * v <= k * M).
  { intros k v Hk Hv. split.
    - replace (- (k * M)) with (k * - M) by ring. apply Rmult_le_compat_l; lra.
    - apply Rmult_le_compat_l; lra. }
  pose proof (Hmix a u_s Ha Hs). pose proof (Hmix b ubar Hb Hu).
  pose proof (Hmix (1 - a - b) u_f ltac:(lra) Hf).
  pose proof (Hmix c ubar ltac:(lra) Hu). pose proof (Hmix (1 - c) u_s ltac:(lra) Hs).
  split; lra.
Qed.

(** The weights of the exact solution are such weights. For bandwidths f and s
    and a period h they are a = f (e^-fh - e^-sh) / (s - f) and what is left of
    1 - e^-fh. *)

Lemma tangent : forall x, 1 + x <= exp x.
Proof.
  intros x. destruct (Req_dec x 0) as [->|Hx]; [rewrite exp_0; lra|]. left. now apply exp_ineq1.
Qed.

(** The exponential is convex: on [0, q h], at p h. *)
Lemma exponential_convex : forall p q h, 0 <= p <= q -> 0 < q ->
  q * exp (- (p * h)) <= (q - p) + p * exp (- (q * h)).
Proof.
  intros p q h Hp Hq.
  set (m := exp (- (p * h))). assert (Hm : 0 < m) by apply exp_pos.
  assert (H0 : m * (1 + p * h) <= 1).
  { apply Rle_trans with (m * exp (p * h)).
    - apply Rmult_le_compat_l; [lra | apply tangent].
    - unfold m. rewrite <- exp_plus. replace (- (p * h) + p * h) with 0 by ring. rewrite exp_0. lra. }
  assert (H1 : m * (1 - (q - p) * h) <= exp (- (q * h))).
  { replace (exp (- (q * h))) with (m * exp (- ((q - p) * h))).
    - apply Rmult_le_compat_l; [lra|]. pose proof (tangent (- ((q - p) * h))). lra.
    - unfold m. rewrite <- exp_plus. f_equal. ring. }
  apply Rmult_le_compat_l with (r := q - p) in H0; [|lra].
  apply Rmult_le_compat_l with (r := p) in H1; [|lra]. lra.
Qed.

Theorem weights_of_the_exact_solution : forall f s h, 0 < f -> 0 < s -> f <> s -> 0 < h ->
  let a := f * (exp (- (f * h)) - exp (- (s * h))) / (s - f) in
  let whole := 1 - exp (- (f * h)) in
  0 <= a /\ 0 <= whole - a /\ a + (whole - a) <= 1 /\ 0 <= 1 - exp (- (s * h)) <= 1.
Proof.
  intros f s h Hf Hs Hne Hh a whole.
  assert (Hrange : forall k, 0 < k -> 0 < exp (- (k * h)) < 1).
  { intros k Hk. split; [apply exp_pos|]. rewrite <- exp_0. apply exp_increasing.
    assert (0 < k * h) by nra. lra. }
  pose proof (Hrange f Hf). pose proof (Hrange s Hs).
  destruct (Rlt_dec f s) as [Hlt|Hge].
  - pose proof (exponential_convex f s h ltac:(lra) Hs) as Hc.
    assert (exp (- (s * h)) <= exp (- (f * h))).
    { left. apply exp_increasing. assert (f * h < s * h) by nra. lra. }
    assert (Ha : 0 <= a).
    { unfold a. apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat; lra]. }
    assert (a <= whole).
    { apply Rmult_le_reg_r with (s - f); [lra|]. unfold a, whole.
      replace (f * (exp (- (f * h)) - exp (- (s * h))) / (s - f) * (s - f))
        with (f * (exp (- (f * h)) - exp (- (s * h)))) by (field; lra). lra. }
    unfold whole in *. repeat split; lra.
  - pose proof (exponential_convex s f h ltac:(lra) Hf) as Hc.
    assert (exp (- (f * h)) <= exp (- (s * h))).
    { left. apply exp_increasing. assert (s * h < f * h) by nra. lra. }
    assert (Hsame : a = f * (exp (- (s * h)) - exp (- (f * h))) / (f - s)) by (unfold a; field; lra).
    assert (Ha : 0 <= a).
    { rewrite Hsame. apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; apply Rinv_0_lt_compat; lra]. }
    assert (a <= whole).
    { rewrite Hsame. apply Rmult_le_reg_r with (f - s); [lra|]. unfold whole.
      replace (f * (exp (- (s * h)) - exp (- (f * h))) / (f - s) * (f - s))
        with (f * (exp (- (s * h)) - exp (- (f * h)))) by (field; lra). lra. }
    unfold whole in *. repeat split; lra.
Qed.

(** ** Theorem 1's thrust interval

    u = u_f + g e3 + a with u_f in the box of M and the reference's acceleration
    within K_12 across and K_3 along the vertical. T = m |u|. The sharp interval
    first: it is reached. Then the paper's, which has the same lower end. *)

Section Thrust.

Variables (g M K_12 K_3 : R).
Hypothesis levels : 0 < M /\ 0 <= K_12 /\ 0 <= K_3.
Hypothesis hover_is_left : M + K_3 < g.

Theorem thrust_interval : forall m f_1 f_2 f_3 a_1 a_2 a_3,
  0 < m ->
  - M <= f_1 <= M -> - M <= f_2 <= M -> - M <= f_3 <= M ->
  a_1 * a_1 + a_2 * a_2 <= K_12 * K_12 -> - K_3 <= a_3 <= K_3 ->
  let u_1 := f_1 + a_1 in let u_2 := f_2 + a_2 in let u_3 := f_3 + g + a_3 in
  let T := m * sqrt (u_1 * u_1 + u_2 * u_2 + u_3 * u_3) in
  m * (g - M - K_3) <= T <=
  m * sqrt ((sqrt 2 * M + K_12) * (sqrt 2 * M + K_12) + (g + M + K_3) * (g + M + K_3)).
Proof.
  intros m f_1 f_2 f_3 a_1 a_2 a_3 Hm H1 H2 H3 Ha Ha3 u_1 u_2 u_3 T.
  assert (Hs2 : sqrt 2 * sqrt 2 = 2) by (apply sqrt_def; lra).
  assert (Hs2p : 0 < sqrt 2) by (apply sqrt_lt_R0; lra).
  assert (Hu3 : g - M - K_3 <= u_3 <= g + M + K_3) by (unfold u_3; lra).
  split; apply Rmult_le_compat_l; try lra.
  - rewrite <- (sqrt_square (g - M - K_3)) by lra. apply sqrt_le_1_alt.
    pose proof (Rle_0_sqr u_1). pose proof (Rle_0_sqr u_2). unfold Rsqr in *. nra.
  - apply sqrt_le_1_alt.
    assert (Hff : f_1 * f_1 + f_2 * f_2 <= (sqrt 2 * M) * (sqrt 2 * M)).
    { replace (sqrt 2 * M * (sqrt 2 * M)) with ((sqrt 2 * sqrt 2) * (M * M)) by ring. rewrite Hs2. nra. }
    assert (Hcross : f_1 * a_1 + f_2 * a_2 <= sqrt 2 * M * K_12).
    { apply Rsqr_incr_0_var; [|apply Rmult_le_pos; [nra | lra]]. unfold Rsqr.
      apply Rle_trans with ((f_1 * f_1 + f_2 * f_2) * (a_1 * a_1 + a_2 * a_2)).
      - pose proof (Rle_0_sqr (f_1 * a_2 - f_2 * a_1)) as Hq. unfold Rsqr in Hq. lra.
      - replace (sqrt 2 * M * K_12 * (sqrt 2 * M * K_12)) with ((sqrt 2 * M * (sqrt 2 * M)) * (K_12 * K_12)) by ring.
        apply Rmult_le_compat; try assumption;
          [pose proof (Rle_0_sqr f_1); pose proof (Rle_0_sqr f_2) | pose proof (Rle_0_sqr a_1);
            pose proof (Rle_0_sqr a_2)];
          unfold Rsqr in *; lra. }
    assert (u_3 * u_3 <= (g + M + K_3) * (g + M + K_3)) by (apply Rmult_le_compat; lra).
    unfold u_1, u_2. nra.
Qed.

(** The longest u is (sqrt 2 M, M) and (K_12, g + K_3), one after the other. *)
Lemma no_longer_than_both : forall a b c d, 0 <= a -> 0 <= b -> 0 <= c -> 0 <= d ->
  sqrt ((a + c) * (a + c) + (b + d) * (b + d)) <= sqrt (a * a + b * b) + sqrt (c * c + d * d).
Proof.
  intros a b c d Ha Hb Hc Hd.
  assert (Hu : 0 <= a * a + b * b) by nra. assert (Hv : 0 <= c * c + d * d) by nra.
  pose proof (sqrt_pos (a * a + b * b)). pose proof (sqrt_pos (c * c + d * d)).
  pose proof (sqrt_def _ Hu). pose proof (sqrt_def _ Hv).
  apply Rsqr_incr_0_var; [|lra]. unfold Rsqr. rewrite sqrt_def by nra.
  assert (a * c + b * d <= sqrt (a * a + b * b) * sqrt (c * c + d * d)).
  { rewrite <- sqrt_mult_alt by lra. rewrite <- (sqrt_square (a * c + b * d)) by nra. apply sqrt_le_1_alt.
    pose proof (Rle_0_sqr (a * d - b * c)) as Hq. unfold Rsqr in Hq. lra. }
  lra.
Qed.

Theorem thrust_interval_as_printed : forall m f_1 f_2 f_3 a_1 a_2 a_3,
  0 < m ->
  - M <= f_1 <= M -> - M <= f_2 <= M -> - M <= f_3 <= M ->
  a_1 * a_1 + a_2 * a_2 <= K_12 * K_12 -> - K_3 <= a_3 <= K_3 ->
  let u_1 := f_1 + a_1 in let u_2 := f_2 + a_2 in let u_3 := f_3 + g + a_3 in
  let T := m * sqrt (u_1 * u_1 + u_2 * u_2 + u_3 * u_3) in
  m * (g - M - K_3) <= T <= m * (sqrt 3 * M + sqrt (K_12 * K_12 + (g + K_3) * (g + K_3))).
Proof.
  intros m f_1 f_2 f_3 a_1 a_2 a_3 Hm H1 H2 H3 Ha Ha3 u_1 u_2 u_3 T.
  destruct (thrust_interval m f_1 f_2 f_3 a_1 a_2 a_3 Hm H1 H2 H3 Ha Ha3) as [Hlow Hhigh].
  split; [exact Hlow|]. eapply Rle_trans; [exact Hhigh|]. apply Rmult_le_compat_l; [lra|].
  replace (g + M + K_3) with (M + (g + K_3)) by ring.
  pose proof (sqrt_pos 2). eapply Rle_trans; [apply no_longer_than_both; nra|].
  apply Rplus_le_compat_r. right.
  replace (sqrt 2 * M * (sqrt 2 * M) + M * M) with (3 * (M * M))
    by (replace (sqrt 2 * M * (sqrt 2 * M)) with (sqrt 2 * sqrt 2 * (M * M)) by ring; rewrite sqrt_def by lra; ring).
  rewrite sqrt_mult_alt by lra. rewrite sqrt_square by lra. reflexivity.
Qed.

End Thrust.
