(** * The tube: bounds on a loop's signals that hold for ever

    docs/recovery.md, in exact arithmetic; scenario/src/tube.rs. *)

From Coq Require Import Reals Lra Lia Arith.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

(** ** What comes out of a loop *)

(** The response g of a loop to what came to it, u, tick by tick. *)
Definition response (g u : nat -> R) (k : nat) : R := sum_f_R0 (fun l => g l * u (k - l)%nat) k.

Theorem response_bounded : forall g u U G k, 0 <= U -> (forall l, (l <= k)%nat -> Rabs (u l) <= U) ->
  sum_f_R0 (fun l => Rabs (g l)) k <= G -> Rabs (response g u k) <= G * U.
Proof.
  intros g u U G k HU Hu HG. unfold response.
  apply Rle_trans with (sum_f_R0 (fun l => Rabs (g l * u (k - l)%nat)) k); [apply Rsum_abs|].
  apply Rle_trans with (sum_f_R0 (fun l => Rabs (g l) * U) k).
  - apply sum_Rle. intros l Hl. rewrite Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos|]. apply Hu. lia.
  - rewrite <- scal_sum, Rmult_comm. now apply Rmult_le_compat_r.
Qed.

(** What follows of a sum, once each part is no more than rho times the last. *)
Theorem rest_bounded : forall (a : nat -> R) rho n, 0 <= rho < 1 -> (forall k, 0 <= a k) ->
  (forall k, a (S k) <= rho * a k) -> sum_f_R0 a n <= a 0%nat / (1 - rho).
Proof.
  intros a rho n Hrho Ha Hless.
  enough (H : sum_f_R0 a n + rho * a n / (1 - rho) <= a 0%nat / (1 - rho)).
  { assert (0 <= rho * a n / (1 - rho)) by (apply Rdiv_le_0_compat; [apply Rmult_le_pos; [lra|apply Ha]|lra]). lra. }
  induction n as [|n IH].
  - cbn. right. field. lra.
  - cbn [sum_f_R0]. apply Rle_trans with (2 := IH).
    replace (sum_f_R0 a n + a (S n) + rho * a (S n) / (1 - rho)) with (sum_f_R0 a n + a (S n) / (1 - rho))
      by (field; lra).
    apply Rplus_le_compat_l. apply Rmult_le_compat_r; [|apply Hless]. left. apply Rinv_0_lt_compat. lra.
Qed.

(** ** Bounds that hold themselves

    Everything that a loop's ticks work out, e, comes at a stage of the tick, and
    depends on what came before it alone. *)
Theorem bounds_hold : forall (E : Type) (stage : E -> nat) (q : E -> nat -> R) (bound : E -> R),
  (forall e k, (forall e' k', (k' < k)%nat \/ k' = k /\ (stage e' < stage e)%nat -> Rabs (q e' k') <= bound e') ->
    Rabs (q e k) <= bound e) ->
  forall e k, Rabs (q e k) <= bound e.
Proof.
  intros E stage q bound Hstep e k. revert e.
  induction k as [k IHk] using lt_wf_ind.
  enough (H : forall n e, (stage e < n)%nat -> Rabs (q e k) <= bound e) by (intros e; apply (H (S (stage e))); lia).
  induction n as [|n IHn]; intros e He; [lia|].
  apply Hstep. intros e' k' [Hk|[-> Hs]]; [now apply IHk|]. apply IHn. lia.
Qed.

(** ** Thrust beside a tilt's error

    n and lambda are the length and the tilt of u, e the tilt beyond it, and the
    thrust is n* cos e with n* = n + more / cos lambda. *)
Theorem thrust_across : forall n more lambda e, cos lambda <> 0 ->
  (n + more / cos lambda) * cos e * sin (lambda + e) =
  (n * sin lambda + more * (sin lambda / cos lambda)) * (cos e * cos e)
  + (n * cos lambda + more) * (sin e * cos e).
Proof. intros n more lambda e H. rewrite sin_plus. field. exact H. Qed.

Theorem thrust_along : forall n more lambda e, cos lambda <> 0 ->
  (n + more / cos lambda) * cos e * cos (lambda + e) =
  (n * cos lambda + more) * (cos e * cos e)
  - (n * sin lambda + more * (sin lambda / cos lambda)) * (sin e * cos e).
Proof. intros n more lambda e H. rewrite cos_plus. field. exact H. Qed.

(** What is left of a tilt's error beside the small one. *)
Theorem small_tilt : forall e, 0 <= e <= 1 -> Rabs (sin e * cos e - e) <= 2 / 3 * (e * e * e).
Proof.
  intros e He. replace (sin e * cos e) with (sin (2 * e) / 2) by (rewrite sin_2a; lra).
  assert (HPI : 2 < PI) by (pose proof PI2_1; lra).
  destruct (SIN (2 * e)) as [Hlow _]; [lra|lra|].
  assert (Hup : sin (2 * e) <= 2 * e).
  { destruct (Req_dec e 0) as [->|Hne]; [rewrite Rmult_0_r, sin_0; lra|]. left. apply sin_lt_x. lra. }
  unfold sin_lb, sin_approx, sin_term in Hlow. cbn [sum_f_R0 Nat.mul Nat.add fact pow INR] in Hlow.
  assert (Hcube : 0 <= e * e * e) by (repeat apply Rmult_le_pos; lra).
  assert (Hfifth : 0 <= e * e * e * (e * e) * (42 - 4 * (e * e))).
  { assert (e * e <= 1 * 1) by (apply Rmult_le_compat; lra). assert (0 <= e * e) by (apply Rmult_le_pos; lra).
    apply Rmult_le_pos; [apply Rmult_le_pos; lra|lra]. }
  apply Rabs_le. split; [|lra].
  enough (2 * e - 4 / 3 * (e * e * e) <= sin (2 * e)) by lra.
  apply Rle_trans with (2 := Hlow). simpl INR. field_simplify. lra.
Qed.

(** ** How the desired tilt bends

    c across and w upwards; r is how fast |u| grows and p how fast it turns. *)
Section Tilt.
Variables c w c' w' : R -> R.
Variables t c'' w'' : R.
Hypothesis c_moves : forall s, is_derive c s (c' s).
Hypothesis w_moves : forall s, is_derive w s (w' s).
Hypothesis c'_moves : is_derive c' t c''.
Hypothesis w'_moves : is_derive w' t w''.
Hypothesis upwards : forall s, 0 < w s.

Definition squared_length (s : R) : R := c s * c s + w s * w s.
Definition turn (s : R) : R := (c' s * w s - w' s * c s) / squared_length s.

Lemma length_positive : forall s, 0 < squared_length s.
Proof.
  intros s. unfold squared_length. pose proof (Rle_0_sqr (c s)) as H. unfold Rsqr in H.
  pose proof (Rmult_lt_0_compat _ _ (upwards s) (upwards s)). lra.
Qed.

Theorem tilt_turns : forall s, is_derive (fun s => atan (c s / w s)) s (turn s).
Proof.
  intros s. pose proof (upwards s). pose proof (length_positive s) as Hl. unfold squared_length in Hl.
  assert (Hc : ex_derive c s) by (eexists; apply c_moves). assert (Hw : ex_derive w s) by (eexists; apply w_moves).
  auto_derive; [repeat split; try assumption; lra|].
  rewrite (is_derive_unique (fun x : R => c x) s _ (c_moves s) : Derive (fun x : R => c x) s = _),
    (is_derive_unique (fun x : R => w x) s _ (w_moves s) : Derive (fun x : R => w x) s = _).
  unfold turn, squared_length. field. lra.
Qed.

Theorem tilt_bends : is_derive turn t
  ((c'' * w t - w'' * c t) / squared_length t - 2 * ((c t * c' t + w t * w' t) / squared_length t) * turn t).
Proof.
  pose proof (length_positive t) as Hl. unfold squared_length in Hl. unfold turn, squared_length.
  assert (Hc : ex_derive c t) by (eexists; apply c_moves). assert (Hw : ex_derive w t) by (eexists; apply w_moves).
  assert (Hc' : ex_derive c' t) by (eexists; apply c'_moves).
  assert (Hw' : ex_derive w' t) by (eexists; apply w'_moves).
  auto_derive; [repeat split; try assumption; lra|].
  rewrite (is_derive_unique (fun x : R => c x) t _ (c_moves t) : Derive (fun x : R => c x) t = _),
    (is_derive_unique (fun x : R => w x) t _ (w_moves t) : Derive (fun x : R => w x) t = _),
    (is_derive_unique (fun x : R => c' x) t _ c'_moves : Derive (fun x : R => c' x) t = _),
    (is_derive_unique (fun x : R => w' x) t _ w'_moves : Derive (fun x : R => w' x) t = _).
  field. lra.
Qed.
End Tilt.
