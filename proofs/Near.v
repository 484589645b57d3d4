(** * What roundings make of a number

    A number that single precision rounds n times differs from the exact one by
    a share of its size, and by some dust from numbers near zero. The rules say
    how both add up over sums and products; Rounding.v puts the code's steps
    together with them. *)

From Coq Require Import Reals Lra Lia.
Open Scope R_scope.

(** What one rounding changes at most: a share, 2^-24 and a little for what
    double precision rounded before, and half of the least number above zero
    and a little, for numbers below 1e-37 have fewer digits. *)
Definition unit : R := 6 / 100000000.
Definition tiny : R := 1 / 1000000000000000000000000000000000000000000000.

Lemma both_sides : forall a b, Rabs a <= b -> - b <= a <= b.
Proof. intros a b. unfold Rabs. destruct (Rcase_abs a); lra. Qed.

Section Rounding.

Variable rnd : R -> R.
Hypothesis rnd_close : forall x, Rabs (rnd x - x) <= unit * Rabs x + tiny.

(** What n roundings make of a share. *)
Definition share (n : nat) : R := (1 + unit) ^ n - 1.

(** [y] is what n roundings made of [x], a sum of numbers whose sizes add up to
    no more than [size]; beside their share they changed it by [dust]. *)
Definition near (n : nat) (size dust x y : R) : Prop :=
  Rabs x <= size /\ Rabs (y - x) <= share n * size + dust.

Lemma share_nonneg : forall n, 0 <= share n.
Proof.
  intros n. unfold share.
  assert (1 <= (1 + unit) ^ n); [|lra]. apply pow_R1_Rle. unfold unit. lra.
Qed.

Lemma share_grows : forall n, share n <= share (S n).
Proof.
  intros n. pose proof (share_nonneg n). unfold share in *. cbn [pow].
  assert (0 <= unit) by (unfold unit; lra). nra.
Qed.

Lemma share_of_six : share 6 <= 361 / 1000000000.
Proof. unfold share, unit. cbn [pow]. lra. Qed.

Lemma exact : forall x, near 0 (Rabs x) 0 x x.
Proof.
  intros x. split; [lra|]. unfold share.
  rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. cbn [pow]. lra.
Qed.

Lemma share_monotone : forall n m, (n <= m)%nat -> share n <= share m.
Proof.
  intros n m H. induction H as [|m H IH]; [lra|]. pose proof (share_grows m). lra.
Qed.

Lemma later : forall n m size dust dust' x y, (n <= m)%nat -> dust <= dust' ->
  near n size dust x y -> near m size dust' x y.
Proof.
  intros n m size dust dust' x y Hn Hd [H E]. split; [exact H|].
  pose proof (share_monotone n m Hn). pose proof (Rabs_pos x). nra.
Qed.

(** Dust at most doubles, and [tiny] comes in. *)
Lemma rounded : forall n size dust x y, 0 <= dust -> near n size dust x y ->
  near (S n) size (2 * dust + tiny) x (rnd y).
Proof.
  intros n size dust x y Hd [H E]. split; [exact H|].
  pose proof (rnd_close y) as R. pose proof (share_nonneg n).
  assert (Hy : Rabs y <= size + (share n * size + dust)).
  { replace y with (x + (y - x)) by ring. eapply Rle_trans; [apply Rabs_triang | lra]. }
  replace (rnd y - x) with ((rnd y - y) + (y - x)) by ring.
  eapply Rle_trans; [apply Rabs_triang|].
  assert (unit * Rabs y <= unit * (size + (share n * size + dust))).
  { apply Rmult_le_compat_l; [unfold unit; lra | exact Hy]. }
  replace (share (S n)) with (share n + unit + share n * unit) by (unfold share; cbn [pow]; ring).
  assert (unit * dust <= dust) by (unfold unit; lra). lra.
Qed.

Lemma added : forall n a b dust dust' x y x' y',
  near n a dust x y -> near n b dust' x' y' -> near n (a + b) (dust + dust') (x + x') (y + y').
Proof.
  intros n a b dust dust' x y x' y' [H E] [H' E']. split.
  - eapply Rle_trans; [apply Rabs_triang | lra].
  - replace (y + y' - (x + x')) with ((y - x) + (y' - x')) by ring.
    eapply Rle_trans; [apply Rabs_triang | lra].
Qed.

Lemma negated : forall n size dust x y, near n size dust x y -> near n size dust (- x) (- y).
Proof.
  intros n size dust x y [H E]. split; [now rewrite Rabs_Ropp|].
  replace (- y - - x) with (- (y - x)) by ring. now rewrite Rabs_Ropp.
Qed.

Lemma subtracted : forall n a b dust dust' x y x' y',
  near n a dust x y -> near n b dust' x' y' -> near n (a + b) (dust + dust') (x - x') (y - y').
Proof. intros. apply added; [assumption | now apply negated]. Qed.

(** Dust of one factor comes in as often as the other is large. *)
Lemma multiplied : forall n m L dust dust' x y x' y', (n <= 6)%nat -> (m <= 6)%nat -> 1 <= L ->
  Rabs x <= L -> Rabs x' <= L -> 0 <= dust <= 1 -> 0 <= dust' <= 1 ->
  near n (Rabs x) dust x y -> near m (Rabs x') dust' x' y' ->
  near (n + m) (Rabs (x * x')) (3 * L * (dust + dust')) (x * x') (y * y').
Proof.
  intros n m L dust dust' x y x' y' Hn Hm HL Hx Hx' Hd Hd' [_ E] [_ E']. split; [lra|].
  pose proof (share_nonneg n). pose proof (share_nonneg m). pose proof share_of_six.
  pose proof (share_monotone n 6 Hn). pose proof (share_monotone m 6 Hm).
  pose proof (Rabs_pos x). pose proof (Rabs_pos x').
  replace (y * y' - x * x') with ((y - x) * x' + (x * (y' - x') + (y - x) * (y' - x'))) by ring.
  eapply Rle_trans; [apply Rabs_triang|].
  eapply Rle_trans; [apply Rplus_le_compat_l, Rabs_triang|].
  rewrite !Rabs_mult.
  replace (share (n + m)) with (share n + share m + share n * share m)
    by (unfold share; rewrite pow_add; ring).
  assert (Rabs (y - x) * Rabs x' <= (share n * Rabs x + dust) * Rabs x') by (apply Rmult_le_compat_r; lra).
  assert (Rabs x * Rabs (y' - x') <= Rabs x * (share m * Rabs x' + dust')) by (apply Rmult_le_compat_l; lra).
  assert (Rabs (y - x) * Rabs (y' - x') <= (share n * Rabs x + dust) * (share m * Rabs x' + dust')).
  { apply Rmult_le_compat; try apply Rabs_pos; lra. }
  assert (dust * Rabs x' <= dust * L) by (apply Rmult_le_compat_l; lra).
  assert (dust' * Rabs x <= dust' * L) by (apply Rmult_le_compat_l; lra).
  assert (share n * (dust' * Rabs x) <= dust' * L).
  { assert (0 <= dust' * Rabs x) by (apply Rmult_le_pos; lra). nra. }
  assert (share m * (dust * Rabs x') <= dust * L).
  { assert (0 <= dust * Rabs x') by (apply Rmult_le_pos; lra). nra. }
  assert (dust * dust' <= dust' * L) by nra. assert (0 <= dust * L) by (apply Rmult_le_pos; lra). lra.
Qed.

Lemma tiny_size : 0 < tiny /\ 100000000000000000000000000000000000 * tiny <= / 1000000000.
Proof. unfold tiny. split; lra. Qed.
End Rounding.
