(** * Rounding takes no rotor out of its range

    From a thrust and a torque to a rotor's command in single precision, step by
    step as the code rounds: controller-core/src/extended/thrust_range.rs
    ([floor], [ceiling]), the caller's division by the thrust scale, and
    controller-core/src/allocation/minimum_norm.rs ([command]). The constants
    are rounded as well: a rotor's row of B+, that row over its first number,
    and the ends of the rotor's range over it.

    [rnd] is rounding to nearest. It changes no number by more than a share
    [unit]: 2^-24, and a little for what double precision rounded before. Numbers
    below 1e-37, for which single precision has fewer digits, are left out. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

Definition unit : R := 6 / 100000000.

(** The margin of the thrust floor, as a share of the greatest thrust. The
    constructor asks for a little more, Extended::FLOOR_MARGIN_LEAST. *)
Definition margin_least : R := 19 / 10000000.

Lemma both_sides : forall a b, Rabs a <= b -> - b <= a <= b.
Proof. intros a b. unfold Rabs. destruct (Rcase_abs a); lra. Qed.

Section Rounding.

Variable rnd : R -> R.
Hypothesis rnd_close : forall x, Rabs (rnd x - x) <= unit * Rabs x.

(** What n roundings make of a share. *)
Definition share (n : nat) : R := (1 + unit) ^ n - 1.

(** [y] is what n roundings made of [x], a sum of numbers whose sizes add up to
    no more than [size]. *)
Definition near (n : nat) (size x y : R) : Prop :=
  Rabs x <= size /\ Rabs (y - x) <= share n * size.

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

Lemma exact : forall x size, Rabs x <= size -> near 0 size x x.
Proof.
  intros x size H. split; [exact H|]. unfold share.
  rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. cbn [pow]. lra.
Qed.

Lemma later : forall n size x y, near n size x y -> near (S n) size x y.
Proof.
  intros n size x y [H E]. split; [exact H|].
  pose proof (share_grows n). pose proof (Rabs_pos x). nra.
Qed.

Lemma rounded : forall n size x y, near n size x y -> near (S n) size x (rnd y).
Proof.
  intros n size x y [H E]. split; [exact H|].
  pose proof (rnd_close y) as R. pose proof (share_nonneg n).
  assert (Hy : Rabs y <= size + share n * size).
  { replace y with (x + (y - x)) by ring. eapply Rle_trans; [apply Rabs_triang | lra]. }
  replace (rnd y - x) with ((rnd y - y) + (y - x)) by ring.
  eapply Rle_trans; [apply Rabs_triang|].
  assert (unit * Rabs y <= unit * (size + share n * size)).
  { apply Rmult_le_compat_l; [unfold unit; lra | exact Hy]. }
  replace (share (S n)) with (share n + unit + share n * unit) by (unfold share; cbn [pow]; ring).
  lra.
Qed.

Lemma added : forall n a b x y x' y',
  near n a x y -> near n b x' y' -> near n (a + b) (x + x') (y + y').
Proof.
  intros n a b x y x' y' [H E] [H' E']. split.
  - eapply Rle_trans; [apply Rabs_triang | lra].
  - replace (y + y' - (x + x')) with ((y - x) + (y' - x')) by ring.
    eapply Rle_trans; [apply Rabs_triang | lra].
Qed.

Lemma negated : forall n size x y, near n size x y -> near n size (- x) (- y).
Proof.
  intros n size x y [H E]. split; [now rewrite Rabs_Ropp|].
  replace (- y - - x) with (- (y - x)) by ring. now rewrite Rabs_Ropp.
Qed.

Lemma subtracted : forall n a b x y x' y',
  near n a x y -> near n b x' y' -> near n (a + b) (x - x') (y - y').
Proof. intros. apply added; [assumption | now apply negated]. Qed.

Lemma multiplied : forall n m x y x' y',
  near n (Rabs x) x y -> near m (Rabs x') x' y' ->
  near (n + m) (Rabs (x * x')) (x * x') (y * y').
Proof.
  intros n m x y x' y' [_ E] [_ E']. split; [lra|].
  pose proof (share_nonneg n). pose proof (share_nonneg m).
  pose proof (Rabs_pos x). pose proof (Rabs_pos x').
  replace (y * y' - x * x') with ((y - x) * x' + (x * (y' - x') + (y - x) * (y' - x'))) by ring.
  eapply Rle_trans; [apply Rabs_triang|].
  eapply Rle_trans; [apply Rplus_le_compat_l, Rabs_triang|].
  rewrite !Rabs_mult.
  replace (share (n + m)) with (share n + share m + share n * share m)
    by (unfold share; rewrite pow_add; ring).
  assert (Rabs (y - x) * Rabs x' <= share n * Rabs x * Rabs x') by (apply Rmult_le_compat_r; lra).
  assert (Rabs x * Rabs (y' - x') <= Rabs x * (share m * Rabs x')) by (apply Rmult_le_compat_l; lra).
  assert (Rabs (y - x) * Rabs (y' - x') <= (share n * Rabs x) * (share m * Rabs x')).
  { apply Rmult_le_compat; try apply Rabs_pos; lra. }
  lra.
Qed.

Section Steps.

(** The thrust scale, the thrust, the torque; a rotor's row of B+ over (T, tau),
    which is B (1, Q_1, Q_2, Q_3); the ends of its range. *)
Variables (s T margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min thrust_max : R).

Definition dot : R :=
  rnd (rnd (rnd (rnd Q_1 * t_1) + rnd (rnd Q_2 * t_2)) + rnd (rnd Q_3 * t_3)).
Definition floor : R := rnd (rnd (s * rnd (thrust_min / B)) + rnd (margin - dot)).
Definition ceiling : R := rnd (rnd (s * rnd (thrust_max / B)) - rnd (dot + margin)).
Definition inverse : R := rnd (1 / s).
Definition part (row asked : R) : R := rnd (rnd row * rnd (asked * inverse)).
Definition command : R :=
  rnd (rnd (part B T + part (B * Q_2) t_2) + rnd (part (B * Q_1) t_1 + part (B * Q_3) t_3)).

(** The greatest thrust of all rotors, N. The certificate's rows bound the torques by it, and the mean of all
    rotors' torque parts is zero: so a thrust that some ceiling admits is not above it. *)
Variable G : R.
Hypothesis row_lifts : 0 < B.
Hypothesis scale_positive : 0 < s.
Hypothesis thrust_range : 0 <= T <= 11 / 10 * G.
Hypothesis torque_parts : Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3) <= 3 / 2 * G.
Hypothesis margin_enough : margin_least * G <= margin.

Lemma own_size : forall x, near 0 (Rabs x) x x.
Proof. intros x. apply exact. lra. Qed.

Lemma dot_near :
  near 4 (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3))
    (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) dot.
Proof.
  assert (P : forall Q t, near 2 (Rabs (Q * t)) (Q * t) (rnd (rnd Q * t))).
  { intros Q t. apply rounded. change 1%nat with (1 + 0)%nat.
    apply multiplied; [apply rounded, own_size | apply own_size]. }
  unfold dot. apply rounded, added; [|apply later, P].
  apply rounded, added; apply P.
Qed.

Lemma end_near : forall e, near 2 (Rabs (s * (e / B))) (s * (e / B)) (rnd (s * rnd (e / B))).
Proof.
  intros e. apply rounded. change 1%nat with (0 + 1)%nat.
  apply multiplied; [apply own_size | apply rounded, own_size].
Qed.

Lemma part_near : forall row asked,
  near 4 (Rabs (row * (asked * (1 / s)))) (row * (asked * (1 / s))) (part row asked).
Proof.
  intros row asked. unfold part. apply rounded. change 3%nat with (1 + 2)%nat.
  apply multiplied; [apply rounded, own_size|]. apply rounded. change 1%nat with (0 + 1)%nat.
  apply multiplied; [apply own_size|]. unfold inverse. apply rounded, own_size.
Qed.

Lemma command_near :
  Rabs (command - B / s * (T + (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3)))
  <= share 6 * (B / s * (26 / 10 * G)).
Proof.
  assert (N := added 5 _ _ _ _ _ _
    (rounded 4 _ _ _ (added 4 _ _ _ _ _ _ (part_near B T) (part_near (B * Q_2) t_2)))
    (rounded 4 _ _ _ (added 4 _ _ _ _ _ _ (part_near (B * Q_1) t_1) (part_near (B * Q_3) t_3)))).
  apply rounded in N. destruct N as [_ N]. fold command in N.
  pose proof (share_nonneg 6).
  assert (Hk : 0 < B / s) by (apply Rdiv_lt_0_compat; assumption).
  assert (Z : forall z, Rabs (B / s * z) = B / s * Rabs z).
  { intros z. rewrite Rabs_mult, (Rabs_right (B / s)); [reflexivity | lra]. }
  replace (B * (T * (1 / s))) with (B / s * T) in N by (field; lra).
  replace (B * Q_1 * (t_1 * (1 / s))) with (B / s * (Q_1 * t_1)) in N by (field; lra).
  replace (B * Q_2 * (t_2 * (1 / s))) with (B / s * (Q_2 * t_2)) in N by (field; lra).
  replace (B * Q_3 * (t_3 * (1 / s))) with (B / s * (Q_3 * t_3)) in N by (field; lra).
  rewrite !Z in N. rewrite (Rabs_right T) in N by lra.
  replace (B / s * (T + (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3)))
    with (B / s * T + B / s * (Q_2 * t_2) + (B / s * (Q_1 * t_1) + B / s * (Q_3 * t_3))) by ring.
  eapply Rle_trans; [exact N|]. apply Rmult_le_compat_l; [assumption|].
  replace (B / s * T + B / s * Rabs (Q_2 * t_2) + (B / s * Rabs (Q_1 * t_1) + B / s * Rabs (Q_3 * t_3)))
    with (B / s * (T + (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3)))) by ring.
  apply Rmult_le_compat_l; lra.
Qed.

Lemma margin_pays : share 6 * (25 / 10 * G + margin) + share 6 * (26 / 10 * G) <= margin.
Proof.
  pose proof share_of_six. pose proof (share_nonneg 6). unfold margin_least in *.
  assert (HG : 0 <= G) by lra. nra.
Qed.

(** A thrust that the rounded floor admits leaves the rotor at its least, at
    least. *)
Theorem rounded_command_at_least : Rabs (s * (thrust_min / B)) <= G ->
  floor <= T -> thrust_min <= command.
Proof.
  intros Hend Hfloor.
  assert (N := added 5 _ _ _ _ _ _
    (later 4 _ _ _ (later 3 _ _ _ (later 2 _ _ _ (end_near thrust_min))))
    (rounded 4 _ _ _ (subtracted 4 _ _ _ _ _ _
      (later 3 _ _ _ (later 2 _ _ _ (later 1 _ _ _ (later 0 _ _ _ (own_size margin))))) dot_near))).
  apply rounded in N. destruct N as [_ N]. fold floor in N.
  pose proof command_near as C. pose proof margin_pays as P. pose proof (share_nonneg 6).
  assert (Hk : 0 < B / s) by (apply Rdiv_lt_0_compat; assumption).
  assert (HG : 0 <= G) by lra. assert (Hm : 0 <= margin) by (unfold margin_least in *; nra).
  rewrite (Rabs_right margin) in N by lra.
  set (D := Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) in *.
  assert (HN : s * (thrust_min / B) + (margin - D) - share 6 * (25 / 10 * G + margin) <= T).
  { apply both_sides in N.
    assert (share 6 * (Rabs (s * (thrust_min / B)) + (margin + (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3))))
      <= share 6 * (25 / 10 * G + margin)) by (apply Rmult_le_compat_l; lra).
    lra. }
  apply both_sides in C.
  assert (HT : B / s * (s * (thrust_min / B) + margin - share 6 * (25 / 10 * G + margin)) <= B / s * (T + D))
    by (apply Rmult_le_compat_l; lra).
  assert (HP : 0 <= B / s * (margin - share 6 * (25 / 10 * G + margin) - share 6 * (26 / 10 * G)))
    by (apply Rmult_le_pos; lra).
  replace (B / s * (s * (thrust_min / B) + margin - share 6 * (25 / 10 * G + margin)))
    with (thrust_min + B / s * (margin - share 6 * (25 / 10 * G + margin))) in HT by (field; lra).
  lra.
Qed.

(** One below the rounded ceiling leaves it at its greatest, at most. *)
Theorem rounded_command_at_most : Rabs (s * (thrust_max / B)) <= G ->
  T <= ceiling -> command <= thrust_max.
Proof.
  intros Hend Hceiling.
  assert (N := subtracted 5 _ _ _ _ _ _
    (later 4 _ _ _ (later 3 _ _ _ (later 2 _ _ _ (end_near thrust_max))))
    (rounded 4 _ _ _ (added 4 _ _ _ _ _ _ dot_near
      (later 3 _ _ _ (later 2 _ _ _ (later 1 _ _ _ (later 0 _ _ _ (own_size margin)))))))).
  apply rounded in N. destruct N as [_ N]. fold ceiling in N.
  pose proof command_near as C. pose proof margin_pays as P. pose proof (share_nonneg 6).
  assert (Hk : 0 < B / s) by (apply Rdiv_lt_0_compat; assumption).
  assert (HG : 0 <= G) by lra. assert (Hm : 0 <= margin) by (unfold margin_least in *; nra).
  rewrite (Rabs_right margin) in N by lra.
  set (D := Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) in *.
  assert (HN : T <= s * (thrust_max / B) - (D + margin) + share 6 * (25 / 10 * G + margin)).
  { apply both_sides in N.
    assert (share 6 * (Rabs (s * (thrust_max / B)) + (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3) + margin))
      <= share 6 * (25 / 10 * G + margin)) by (apply Rmult_le_compat_l; lra).
    lra. }
  apply both_sides in C.
  assert (HT : B / s * (T + D) <= B / s * (s * (thrust_max / B) - margin + share 6 * (25 / 10 * G + margin)))
    by (apply Rmult_le_compat_l; lra).
  assert (HP : 0 <= B / s * (margin - share 6 * (25 / 10 * G + margin) - share 6 * (26 / 10 * G)))
    by (apply Rmult_le_pos; lra).
  replace (B / s * (s * (thrust_max / B) - margin + share 6 * (25 / 10 * G + margin)))
    with (thrust_max - B / s * (margin - share 6 * (25 / 10 * G + margin))) in HT by (field; lra).
  lra.
Qed.

End Steps.
End Rounding.
