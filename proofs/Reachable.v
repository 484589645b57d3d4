(** * What the filters can reach

    |u_f|, |u_f'| and |u_f''| of one axis of the paper's cascade, from rest, for
    inputs of at most M: m/s^2, m/s^3, m/s^4; bandwidths in 1/s.
    controller-core/src/certificate/reachable.rs, docs/sharp-bound.md, step 1;
    the filters' part of the paper's Lemma 1. *)

From Coq Require Import Reals Lra List.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Adjoint.
Open Scope R_scope.

(** U_l: half the L1 norm of the impulse response from ubar to u_f - u_s. *)

Definition half_l1_norm (k_f k_s : R) : R :=
  if Req_EM_T k_f k_s then exp (-1) else Rpower (k_f / k_s) (k_f / (k_s - k_f)).

Section Bounds.

Variables (k_f k_s M : R).
Hypothesis bandwidths : 0 < k_f /\ 0 < k_s.
Hypothesis level : 0 <= M.

(** When u_f - u_s is greatest. *)
Definition peak : R := if Req_EM_T k_f k_s then / k_f else ln (k_s / k_f) / (k_s - k_f).

Lemma decay_at_peak : exp (- (k_f * peak)) = half_l1_norm k_f k_s.
Proof.
  unfold peak, half_l1_norm, Rpower. destruct (Req_EM_T k_f k_s) as [->|Hne].
  - f_equal. field. lra.
  - f_equal. replace (k_f / k_s) with (/ (k_s / k_f)) by (field; lra).
    rewrite ln_Rinv by (apply Rdiv_lt_0_compat; lra). field. lra.
Qed.

Lemma decays_at_peak : k_f <> k_s -> k_s * exp (- (k_s * peak)) = k_f * exp (- (k_f * peak)).
Proof.
  intros Hne. unfold peak. destruct (Req_EM_T k_f k_s) as [|_]; [contradiction|].
  set (l := ln (k_s / k_f)).
  replace (- (k_f * (l / (k_s - k_f)))) with (l + - (k_s * (l / (k_s - k_f)))) by (field; lra).
  rewrite exp_plus. unfold l. rewrite exp_ln by (apply Rdiv_lt_0_compat; lra). field. lra.
Qed.

Lemma peak_positive : 0 < peak.
Proof.
  unfold peak. destruct (Req_EM_T k_f k_s) as [_|Hne]; [apply Rinv_0_lt_compat; lra|].
  assert (Hratio : forall a b, 0 < a < b -> 0 < ln (b / a)).
  { intros a b Hab. rewrite <- ln_1. apply ln_increasing; [lra|].
    apply Rmult_lt_reg_r with a; [lra|]. replace (b / a * a) with b by (field; lra). lra. }
  destruct (Rlt_dec k_f k_s) as [H|H].
  - apply Rdiv_lt_0_compat; [apply Hratio|]; lra.
  - replace (ln (k_s / k_f) / (k_s - k_f)) with (ln (k_f / k_s) / (k_f - k_s)).
    + apply Rdiv_lt_0_compat; [apply Hratio|]; lra.
    + replace (k_f / k_s) with (/ (k_s / k_f)) by (field; lra).
      rewrite ln_Rinv by (apply Rdiv_lt_0_compat; lra). field. lra.
Qed.

Lemma half_l1_norm_range : 0 < half_l1_norm k_f k_s <= 1.
Proof.
  rewrite <- decay_at_peak. split; [apply exp_pos|]. rewrite <- exp_0. left. apply exp_increasing.
  assert (0 < k_f * peak) by (apply Rmult_lt_0_compat; [lra | apply peak_positive]). lra.
Qed.

(** The adjoint from the weights g and w at T. *)
Definition G (g T s : R) : R := g * exp (- (k_f * (T - s))).
Definition W (g w T s : R) : R :=
  if Req_EM_T k_f k_s then (w + g * k_s * (T - s)) * exp (- (k_s * (T - s)))
  else w * exp (- (k_s * (T - s)))
       + g * k_s * (exp (- (k_f * (T - s))) - exp (- (k_s * (T - s)))) / (k_s - k_f).

Lemma G_solves : forall g T s, is_derive (G g T) s (k_f * G g T s).
Proof. intros g T s. unfold G. auto_derive; [exact I|]. unfold Rminus. ring. Qed.

Lemma W_solves : forall g w T s, is_derive (W g w T) s (- (k_s * (G g T s - W g w T s))).
Proof.
  intros g w T s. unfold W, G. destruct (Req_EM_T k_f k_s) as [->|Hne].
  - auto_derive; [exact I|]. unfold Rminus. ring.
  - auto_derive; [lra|]. unfold Rminus. field. lra.
Qed.

Lemma at_the_end : forall g w T, G g T T = g /\ W g w T T = w.
Proof.
  intros g w T. unfold G, W. replace (T - T) with 0 by ring. rewrite !Rmult_0_r, Ropp_0, exp_0.
  split; [ring|]. destruct (Req_EM_T k_f k_s); [ring | field; lra].
Qed.

(** g (u_f - u_s) + w u_s at T, where the weights meet [ago] before T. *)
Lemma linear_function_within : forall g w ago, 0 <= g -> 0 <= ago ->
  (forall T, W g w T (T - ago) = G g T (T - ago)) ->
  forall u_f u_s ubar jumps T, flight k_f k_s M u_f u_s ubar jumps T ->
  Rabs (g * (u_f T - u_s T) + w * u_s T) <= M * (2 * g * exp (- (k_f * ago)) - w).
Proof.
  intros g w ago Hg Hago Hmeet.
  assert (H : forall u_f u_s ubar jumps T, flight k_f k_s M u_f u_s ubar jumps T ->
    g * (u_f T - u_s T) + w * u_s T <= M * (2 * g * exp (- (k_f * ago)) - w)).
  { intros u_f u_s ubar jumps T Hfly.
    assert (Hbefore : T - ago <= T) by lra.
    assert (HG : forall s, 0 <= G g T s) by (intros s; apply Rmult_le_pos; [lra | left; apply exp_pos]).
    pose proof (greatest_linear_function k_f k_s M bandwidths u_f u_s ubar jumps T Hfly (G g T) (W g w T) (T - ago)
      (G_solves g T) (W_solves g w T) HG (conj (Hmeet T) Hbefore) level) as H.
    rewrite (proj1 (at_the_end g w T)), (proj2 (at_the_end g w T)) in H.
    unfold G in H. replace (T - (T - ago)) with ago in H by ring.
    replace (2 * g * exp (- (k_f * ago))) with (2 * (g * exp (- (k_f * ago)))) by ring. exact H. }
  intros u_f u_s ubar jumps T Hfly. pose proof (H _ _ _ _ _ Hfly) as H1.
  pose proof (H _ _ _ _ _ (mirrored k_f k_s M u_f u_s ubar jumps T Hfly)) as H2. cbn beta in H2.
  apply Rabs_le. lra.
Qed.

Section Flown.

Variables (u_f u_s ubar : R -> R) (jumps : list R) (T : R).
Hypothesis flown : flight k_f k_s M u_f u_s ubar jumps T.

Theorem filtered_within_level : Rabs (u_f T) <= M.
Proof.
  replace (u_f T) with (1 * (u_f T - u_s T) + 1 * u_s T) by ring.
  replace M with (M * (2 * 1 * exp (- (k_f * 0)) - 1)) at 1
    by (rewrite Rmult_0_r, Ropp_0, exp_0; ring).
  apply (linear_function_within 1 1 0) with ubar jumps; try lra; [|exact flown].
  intros s. replace (s - 0) with s by ring.
  now rewrite (proj1 (at_the_end 1 1 s)), (proj2 (at_the_end 1 1 s)).
Qed.

Lemma difference_bound : Rabs (u_f T - u_s T) <= 2 * half_l1_norm k_f k_s * M.
Proof.
  replace (u_f T - u_s T) with (1 * (u_f T - u_s T) + 0 * u_s T) by ring.
  replace (2 * half_l1_norm k_f k_s * M) with (M * (2 * 1 * exp (- (k_f * peak)) - 0))
    by (rewrite decay_at_peak; ring).
  apply (linear_function_within 1 0 peak) with ubar jumps; try lra; [left; apply peak_positive | | exact flown].
  intros s. unfold W, G. replace (s - (s - peak)) with peak by ring.
  destruct (Req_EM_T k_f k_s) as [E|Hne].
  - assert (k_s * peak = 1). { unfold peak. destruct (Req_EM_T k_f k_s); [|contradiction]. rewrite E. field. lra. }
    replace (0 + 1 * k_s * peak) with (k_s * peak) by ring. rewrite E, H. reflexivity.
  - pose proof (decays_at_peak Hne) as H. apply Rmult_eq_reg_r with (k_s - k_f); [|lra].
    field_simplify; lra.
Qed.

(** u_f' = - k_f (u_f - u_s). *)
Theorem jerk_of_an_axis : Rabs (- (k_f * (u_f T - u_s T))) <= 2 * k_f * half_l1_norm k_f k_s * M.
Proof.
  rewrite Rabs_Ropp, Rabs_mult, (Rabs_pos_eq k_f) by lra.
  pose proof difference_bound as H. apply (Rmult_le_compat_l k_f) in H; lra.
Qed.

(** u_f'' = k_f (k_f (u_f - u_s) - k_s (u_s - ubar)). *)
Theorem snap_of_an_axis : - M <= ubar T <= M ->
  Rabs (k_f * (k_f * (u_f T - u_s T) - k_s * (u_s T - ubar T)))
  <= 2 * k_f * M * (k_s + k_f * (half_l1_norm k_f k_s * half_l1_norm k_f k_s)).
Proof.
  intros Hu.
  assert (H : Rabs (k_f * (u_f T - u_s T) + - k_s * u_s T)
    <= M * (2 * k_f * exp (- (k_f * (2 * peak))) - - k_s)).
  { pose proof peak_positive. apply (linear_function_within k_f (- k_s) (2 * peak)) with ubar jumps; try lra;
    [|exact flown].
    intros s. unfold W, G. replace (s - (s - 2 * peak)) with (2 * peak) by ring.
    destruct (Req_EM_T k_f k_s) as [E|Hne].
    - assert (Hone : k_s * peak = 1).
      { unfold peak. destruct (Req_EM_T k_f k_s); [|contradiction]. rewrite E. field. lra. }
      replace (- k_s + k_f * k_s * (2 * peak)) with (- k_s + 2 * k_f * (k_s * peak)) by ring.
      rewrite Hone, E. ring.
    - assert (Hdouble : forall k, exp (- (k * (2 * peak))) = exp (- (k * peak)) * exp (- (k * peak))).
      { intros k. rewrite <- exp_plus. f_equal. ring. }
      rewrite !Hdouble. pose proof (decays_at_peak Hne) as Hd.
      assert (Hsquare : k_s * k_s * (exp (- (k_s * peak)) * exp (- (k_s * peak)))
        = k_f * k_f * (exp (- (k_f * peak)) * exp (- (k_f * peak)))).
      { replace (k_s * k_s * (exp (- (k_s * peak)) * exp (- (k_s * peak))))
          with ((k_s * exp (- (k_s * peak))) * (k_s * exp (- (k_s * peak)))) by ring. rewrite Hd. ring. }
      apply Rmult_eq_reg_r with (k_s - k_f); [|lra]. field_simplify; lra. }
  replace (exp (- (k_f * (2 * peak)))) with (half_l1_norm k_f k_s * half_l1_norm k_f k_s) in H
    by (rewrite <- decay_at_peak, <- exp_plus; f_equal; ring).
  assert (Hin : Rabs (k_s * ubar T) <= k_s * M).
  { rewrite Rabs_mult, (Rabs_pos_eq k_s) by lra. apply Rmult_le_compat_l; [lra|]. now apply Rabs_le. }
  rewrite Rabs_mult, (Rabs_pos_eq k_f) by lra.
  replace (2 * k_f * M * (k_s + k_f * (half_l1_norm k_f k_s * half_l1_norm k_f k_s)))
    with (k_f * (M * (2 * k_f * (half_l1_norm k_f k_s * half_l1_norm k_f k_s) - - k_s) + k_s * M)) by ring.
  apply Rmult_le_compat_l; [lra|].
  replace (k_f * (u_f T - u_s T) - k_s * (u_s T - ubar T))
    with (k_f * (u_f T - u_s T) + - k_s * u_s T + k_s * ubar T) by ring.
  eapply Rle_trans; [apply Rabs_triang | lra].
Qed.

End Flown.
End Bounds.
