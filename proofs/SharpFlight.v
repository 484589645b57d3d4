(** * The sharp bound, from the filters on

    [Reachable] of controller-core/src/certificate/reachable.rs: what u, u' and
    u'' can be after a reset, m/s^2, m/s^3, m/s^4; docs/sharp-bound.md, end of
    step 1. With it the cells of [SharpCover] bound the desired frame of every
    flight. u and its derivatives are the command of [Lemma1]. *)

From Coq Require Import Reals Lra List.
From SaturatedHybrid Require Import Space Adjoint Reachable Lemma1 Slope SharpCover.
Open Scope R_scope.

Lemma two_axes : forall a b c, 0 <= c -> Rabs a <= c -> Rabs b <= c -> plane_length a b <= sqrt 2 * c.
Proof.
  intros a b c Hc Ha Hb. assert (H2 : sqrt 2 * sqrt 2 = 2) by (apply sqrt_def; lra).
  apply below_by_squares; [apply Rmult_le_pos; [apply sqrt_pos | exact Hc]|]. rewrite plane_length_squared.
  replace (sqrt 2 * c * (sqrt 2 * c)) with (sqrt 2 * sqrt 2 * (c * c)) by ring. rewrite H2.
  assert (Hsq : forall e, Rabs e <= c -> e * e <= c * c).
  { intros e He. replace (e * e) with (Rabs e * Rabs e) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
    apply squares_below; [apply Rabs_pos | exact He]. }
  pose proof (Hsq _ Ha). pose proof (Hsq _ Hb). lra.
Qed.

Lemma parts_below_length : forall v, plane_length (x v) (y v) <= length v /\ Rabs (z v) <= length v.
Proof.
  intros v. pose proof (squared (x v)). pose proof (squared (y v)). pose proof (squared (z v)).
  split; (apply below_by_squares; [apply length_nonneg|]; rewrite length_squared).
  - rewrite plane_length_squared. components. lra.
  - rewrite <- Rabs_mult, Rabs_pos_eq by apply squared. components. lra.
Qed.

Section Flown.

Variables (k_f k_s M g K_12 K_3 K_j K_s K_nu_1 K_nu_2 : R).
Hypothesis bandwidths : 0 < k_f /\ 0 < k_s.
Hypothesis levels : 0 <= M /\ 0 <= K_12 /\ 0 <= K_nu_2.
Hypothesis hover_is_left : M + K_3 < g.

Definition axis_jerk : R := 2 * k_f * half_l1_norm k_f k_s * M.
Definition axis_snap : R := 2 * k_f * M * (k_s + k_f * (half_l1_norm k_f k_s * half_l1_norm k_f k_s)).

Variables (u_f u_s ubar a a_1 : R -> space) (psi psi_1 : R -> R) (jumps : list R) (t : R) (a_2 : space) (psi_2 : R).
Hypothesis flown_x : flight k_f k_s M (fun s => x (u_f s)) (fun s => x (u_s s)) (fun s => x (ubar s)) jumps t.
Hypothesis flown_y : flight k_f k_s M (fun s => y (u_f s)) (fun s => y (u_s s)) (fun s => y (ubar s)) jumps t.
Hypothesis flown_z : flight k_f k_s M (fun s => z (u_f s)) (fun s => z (u_s s)) (fun s => z (ubar s)) jumps t.
Hypothesis input_x : - M <= x (ubar t) <= M.
Hypothesis input_y : - M <= y (ubar t) <= M.
Hypothesis input_z : - M <= z (ubar t) <= M.
Hypothesis a_across : x (a t) * x (a t) + y (a t) * y (a t) <= K_12 * K_12.
Hypothesis a_vertical : - K_3 <= z (a t) <= K_3.
Hypothesis jerk_level : length (a_1 t) <= K_j.
Hypothesis snap_level : length a_2 <= K_s.
Hypothesis heading_rate_level : Rabs (psi_1 t) <= K_nu_1.
Hypothesis heading_second_level : psi_2 * psi_2 + psi_1 t * psi_1 t * psi_1 t * psi_1 t <= K_nu_2 * K_nu_2.

Let u := command g u_f a.
Let u_1 := command_1 k_f u_f u_s a_1.
Let u_2 := command_2 k_f k_s u_f u_s ubar t a_2.

(** The axes are independent: pairs are bounded by sqrt 2 times an axis. *)
Theorem reachable :
  g - M - K_3 <= z (u t) /\ plane_length (x (u t)) (y (u t)) <= sqrt 2 * M + K_12 /\
  length (u_1 t) <= sqrt 3 * axis_jerk + K_j /\
  plane_length (x (u_1 t)) (y (u_1 t)) <= sqrt 2 * axis_jerk + K_j /\ Rabs (z (u_1 t)) <= axis_jerk + K_j /\
  plane_length (x u_2) (y u_2) <= sqrt 2 * axis_snap + K_s /\ Rabs (z u_2) <= axis_snap + K_s.
Proof.
  destruct levels as (HM & HK & _).
  destruct (command_levels k_f k_s M g K_12 K_3 K_j K_s bandwidths (conj HM HK) u_f u_s ubar a a_1 jumps t a_2
    flown_x flown_y flown_z input_x input_y input_z a_across a_vertical jerk_level snap_level) as (L1 & L2 & L3 & _).
  fold u in L1, L2. fold u_1 in L3. pose proof (half_l1_norm_range k_f k_s bandwidths) as Hl.
  assert (Hj : 0 <= axis_jerk) by (unfold axis_jerk; repeat apply Rmult_le_pos; lra).
  assert (Hs : 0 <= axis_snap).
  { unfold axis_snap. apply Rmult_le_pos; [repeat apply Rmult_le_pos; lra|].
    assert (0 <= k_f * (half_l1_norm k_f k_s * half_l1_norm k_f k_s)) by (repeat apply Rmult_le_pos; lra). lra. }
  destruct (parts_below_length (a_1 t)) as (A1 & A2). destruct (parts_below_length a_2) as (A3 & A4).
  pose proof (jerk_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_x) as Jx.
  pose proof (jerk_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_y) as Jy.
  pose proof (jerk_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_z) as Jz.
  pose proof (snap_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_x input_x) as Sx.
  pose proof (snap_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_y input_y) as Sy.
  pose proof (snap_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_z input_z) as Sz.
  cbv beta in Jx, Jy, Jz, Sx, Sy, Sz. fold axis_jerk in Jx, Jy, Jz. fold axis_snap in Sx, Sy, Sz.
  split; [exact L1|]. split; [|split; [|split; [|split; [|split]]]].
  - apply below_by_squares.
    + apply Rplus_le_le_0_compat; [apply Rmult_le_pos; [apply sqrt_pos | exact HM] | exact HK].
    + rewrite plane_length_squared. exact L2.
  - unfold axis_jerk. unfold jerk_bound in L3. lra.
  - unfold u_1, command_1. cbn [x y add scaled sub]. eapply Rle_trans; [apply plane_triangle|].
    apply Rplus_le_compat; [|lra]. apply two_axes; [exact Hj | |]; now rewrite Ropp_mult_distr_l_reverse.
  - unfold u_1, command_1. cbn [z add scaled sub]. eapply Rle_trans; [apply Rabs_triang|].
    rewrite Ropp_mult_distr_l_reverse. lra.
  - unfold u_2, command_2. cbn [x y add scaled sub]. eapply Rle_trans; [apply plane_triangle|].
    apply Rplus_le_compat; [|lra]. now apply two_axes.
  - unfold u_2, command_2. cbn [z add scaled sub]. eapply Rle_trans; [apply Rabs_triang|]. lra.
Qed.

(** The sharp bound: some cell's bounds are above |omega_d|^2 and |omega_d'|^2,
    also where the input jumps. Where it does not, [rates_in_flight] of [Lemma1]
    says that the one is the other's derivative. *)
Theorem sharp_bound_of_a_flight : forall tilts angles splits headings longest,
  (0 < tilts)%nat -> (0 < angles)%nat -> (0 < splits)%nat -> (0 < headings)%nat ->
  covered u u_1 psi psi_1 t u_2 psi_2 (g - M - K_3) (sqrt 2 * M + K_12) (sqrt 3 * axis_jerk + K_j)
    (sqrt 2 * axis_jerk + K_j) (axis_jerk + K_j) (sqrt 2 * axis_snap + K_s) (axis_snap + K_s) K_nu_1 K_nu_2
    tilts angles splits headings longest.
Proof.
  intros tilts angles splits headings longest H1 H2 H3 H4.
  destruct reachable as (R1 & R2 & R3 & R4 & R5 & R6 & R7). destruct levels as (_ & _ & HK2).
  apply sharp_bound_covers; try assumption. lra.
Qed.

End Flown.
