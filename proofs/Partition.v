(** * Ranges cut into cells

    Evenly, as [desired_rates] and [Direction] in controller-core/src/certificate/
    sharp.rs cut the tilt, the share of u', the heading's rate, and the angle of a
    horizontal vector to the slope. *)

From Coq Require Import Reals Lra Lia.
From SaturatedHybrid Require Import Space.
Open Scope R_scope.

(** [0, greatest] in so many cells: an end of one. *)
Definition end_of (greatest : R) (cells k : nat) : R := greatest * INR k / INR cells.

Lemma in_some_cell : forall cells greatest v, (0 < cells)%nat -> 0 <= v <= greatest ->
  exists k, (k < cells)%nat /\ 0 <= end_of greatest cells k <= v /\ v <= end_of greatest cells (S k).
Proof.
  intros cells top v Hcells Hv. assert (Hn : 0 < INR cells) by (now apply lt_0_INR).
  assert (Hpos : forall k, 0 <= end_of top cells k).
  { intros k. unfold end_of, Rdiv. apply Rmult_le_pos; [apply Rmult_le_pos; [lra | apply pos_INR]|].
    left. now apply Rinv_0_lt_compat. }
  assert (H : forall m, (m <= cells)%nat -> (0 < m)%nat -> v <= end_of top cells m ->
    exists k, (k < m)%nat /\ 0 <= end_of top cells k <= v /\ v <= end_of top cells (S k)).
  { induction m as [|m IH]; intros Hm Hm0 Hle; [lia|].
    destruct (Rle_dec (end_of top cells m) v) as [H|H].
    - exists m. repeat split; try lia; auto.
    - destruct m as [|m].
      + exfalso. apply H. unfold end_of. cbn [INR]. unfold Rdiv. rewrite Rmult_0_r, Rmult_0_l. lra.
      + destruct (IH ltac:(lia) ltac:(lia) ltac:(lra)) as (k & Hk & Hrest). exists k. split; [lia | exact Hrest]. }
  apply H; try lia. unfold end_of. replace (top * INR cells / INR cells) with top by (field; lra). lra.
Qed.

(** The cells of a quarter turn. *)
Definition angle (angles k : nat) : R := end_of (PI / 2) angles k.

Lemma in_some_direction : forall angles a_cos a_sin, (0 < angles)%nat -> a_cos * a_cos + a_sin * a_sin = 1 ->
  exists k, (k < angles)%nat /\ 0 <= cos (angle angles (S k)) <= Rabs a_cos /\
    Rabs a_cos <= cos (angle angles k) /\ Rabs a_sin <= sin (angle angles (S k)).
Proof.
  intros angles a s Hangles Ha. pose proof PI_RGT_0 as Hpi.
  pose proof (Rabs_pos a) as Ha0. pose proof (Rabs_pos s) as Hs0.
  assert (Haa : Rabs a * Rabs a = a * a) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
  assert (Hss : Rabs s * Rabs s = s * s) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
  assert (Hs1 : Rabs s <= 1) by (apply below_by_squares; [lra|]; pose proof (squared a); lra).
  set (th := asin (Rabs s)).
  assert (Hsin : sin th = Rabs s) by (apply sin_asin; lra).
  pose proof (asin_bound (Rabs s)) as Hb. fold th in Hb.
  assert (Hth : 0 <= th).
  { apply Rnot_lt_le. intros Hneg. pose proof (sin_lt_0_var th ltac:(lra) Hneg). lra. }
  assert (Hcos : cos th = Rabs a).
  { assert (Hc0 : 0 <= cos th) by (apply cos_ge_0; lra). pose proof (sin2_cos2 th) as Hc. unfold Rsqr in Hc.
    rewrite Hsin in Hc.
    apply Rle_antisym; apply below_by_squares; lra. }
  destruct (in_some_cell angles (PI / 2) th Hangles ltac:(lra)) as (k & Hk & Hlow & Hhigh).
  assert (Hend : end_of (PI / 2) angles (S k) <= PI / 2).
  { unfold end_of. assert (Hn : 0 < INR angles) by (now apply lt_0_INR).
    apply Rmult_le_reg_r with (INR angles); [exact Hn|].
    replace (PI / 2 * INR (S k) / INR angles * INR angles) with (PI / 2 * INR (S k)) by (field; lra).
    apply Rmult_le_compat_l; [lra|]. apply le_INR. lia. }
  exists k. unfold angle. split; [exact Hk|]. split; [split|split].
  - apply cos_ge_0; lra.
  - rewrite <- Hcos. apply cos_decr_1; lra.
  - rewrite <- Hcos. apply cos_decr_1; lra.
  - rewrite <- Hsin. apply sin_incr_1; lra.
Qed.
