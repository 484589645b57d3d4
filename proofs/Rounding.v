(** * Rounding takes no rotor out of its range

    From a thrust and a torque to a rotor's command in single precision, step by
    step as the code rounds: controller-core/src/extended/thrust_range.rs
    ([floor], [ceiling]), the caller's division by the thrust scale, and
    controller-core/src/allocation/minimum_norm.rs ([command]). The constants
    are rounded as well: a rotor's row of B+, that row over its first number,
    and the ends of the rotor's range over it.

    [rnd] is rounding to nearest; Near.v says what it may change. [sizes] says
    within what the inputs are, in SI units: so nothing comes near the greatest
    number of single precision. *)

From Coq Require Import Reals Lra Lia List.
From SaturatedHybrid Require Import Near.
Open Scope R_scope.

Definition greatest_size : R := 10000.

(** The margin of the thrust floor, as a share of the greatest thrust. The
    constructor asks for a little more, Extended::FLOOR_MARGIN_LEAST. *)
Definition margin_least : R := 19 / 10000000.

Section Rounding.

Variable rnd : R -> R.
Hypothesis rnd_close : forall x, Rabs (rnd x - x) <= unit * Rabs x + tiny.
Let rounded := Near.rounded rnd rnd_close.

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
Definition within (x : R) : Prop := Rabs x <= greatest_size.
Definition sizes : Prop :=
  (/ greatest_size <= s <= greatest_size /\ / greatest_size <= B <= greatest_size
   /\ / greatest_size <= G <= greatest_size)
  /\ (within Q_1 /\ within Q_2 /\ within Q_3) /\ (within t_1 /\ within t_2 /\ within t_3)
  /\ Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3) <= 3 / 2 * G.
Hypothesis within_sizes : sizes.

Lemma part_positive : 0 < B / s.
Proof.
  destruct within_sizes as ((Hs & HB & _) & _). unfold greatest_size in *.
  apply Rdiv_lt_0_compat; lra.
Qed.

Lemma constant_near : forall x, near 1 (Rabs x) tiny x (rnd x).
Proof.
  intros x. apply (later 1 1 _ (2 * 0 + tiny)); [lia | lra|]. apply rounded; [lra | apply exact].
Qed.

Lemma dot_near :
  near 4 (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3)) (2000000 * tiny)
    (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) dot.
Proof.
  destruct tiny_size as [H0 H1]. destruct within_sizes as (_ & (Q1 & Q2 & Q3) & (T1 & T2 & T3) & _).
  assert (P : forall Q t, within Q -> within t -> near 2 (Rabs (Q * t)) (100000 * tiny) (Q * t) (rnd (rnd Q * t))).
  { intros Q t HQ Ht. apply (later 2 2 _ (2 * (3 * greatest_size * (tiny + 0)) + tiny));
      [lia | unfold greatest_size; lra|].
    apply rounded; [unfold greatest_size; lra|]. change 1%nat with (1 + 0)%nat.
    apply multiplied; try assumption; try (unfold greatest_size; lra); try lia;
      [apply constant_near | apply exact]. }
  pose proof (P _ _ Q1 T1) as P1. pose proof (P _ _ Q2 T2) as P2. pose proof (P _ _ Q3 T3) as P3.
  assert (S12 := added _ _ _ _ _ _ _ _ _ P1 P2). apply rounded in S12; [|lra].
  apply (later 2 3 _ _ _ _ _ ltac:(lia) (Rle_refl _)) in P3.
  assert (S := added _ _ _ _ _ _ _ _ _ S12 P3). apply rounded in S; [|lra].
  eapply later; [| |exact S]; [lia | lra].
Qed.

Lemma end_near : forall e, Rabs (s * (e / B)) <= G ->
  near 2 (Rabs (s * (e / B))) (1000000000 * tiny) (s * (e / B)) (rnd (s * rnd (e / B))).
Proof.
  intros e He. destruct tiny_size as [H0 H1]. destruct within_sizes as ((Hs & _ & HG) & _).
  unfold greatest_size in *.
  assert (Hsize : Rabs (e / B) <= 100000000).
  { rewrite Rabs_mult, (Rabs_right s) in He by lra. pose proof (Rabs_pos (e / B)). nra. }
  apply (later 2 2 _ (2 * (3 * 100000000 * (0 + tiny)) + tiny)); [lia | lra|].
  apply rounded; [lra|]. change 1%nat with (0 + 1)%nat.
  apply multiplied; try lra; try lia; try apply exact; try apply constant_near.
  rewrite Rabs_right; lra.
Qed.

Lemma part_near : forall row asked, Rabs row <= 1000000000 -> Rabs asked <= 20000 ->
  near 4 (Rabs (row * (asked * (1 / s)))) (4000000000000000 * tiny) (row * (asked * (1 / s))) (part row asked).
Proof.
  intros row asked Hrow Hasked. destruct tiny_size as [H0 H1]. destruct within_sizes as ((Hs & _) & _).
  unfold greatest_size in *.
  assert (Hinv : Rabs (1 / s) <= 10000).
  { rewrite Rabs_right by (apply Rle_ge, Rlt_le, Rdiv_lt_0_compat; lra).
    apply Rmult_le_reg_r with s; [lra|]. replace (1 / s * s) with 1 by (field; lra). lra. }
  assert (Hsize : Rabs (asked * (1 / s)) <= 1000000000).
  { rewrite Rabs_mult. apply Rle_trans with (20000 * 10000); [|lra].
    apply Rmult_le_compat; try apply Rabs_pos; assumption. }
  unfold part, inverse.
  apply (later 4 4 _ (2 * (3 * 1000000000 * (tiny + (2 * (3 * 20000 * (0 + tiny)) + tiny))) + tiny));
    [lia | lra|].
  apply rounded; [lra|]. change 3%nat with (1 + 2)%nat.
  apply multiplied; try assumption; try lra; try lia; try apply constant_near.
  apply rounded; [lra|]. change 1%nat with (0 + 1)%nat.
  apply multiplied; try assumption; try lra; try lia; try apply exact; try apply constant_near.
Qed.

Lemma floor_near : Rabs (s * (thrust_min / B)) <= G -> 0 <= margin ->
  Rabs (floor - (s * (thrust_min / B) - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) + margin))
  <= share 6 * (25 / 10 * G + margin) + 10000000000 * tiny.
Proof.
  intros Hend Hm. destruct tiny_size as [H0 H1]. destruct within_sizes as (_ & _ & _ & Hparts).
  assert (M := subtracted _ _ _ _ _ _ _ _ _
    (later 0 4 _ 0 0 _ _ ltac:(lia) (Rle_refl _) (exact margin)) dot_near).
  apply rounded in M; [|lra].
  assert (N := added _ _ _ _ _ _ _ _ _
    (later 2 5 _ _ _ _ _ ltac:(lia) (Rle_refl _) (end_near thrust_min Hend)) M).
  apply rounded in N; [|lra]. destruct N as [_ N]. fold floor in N. rewrite (Rabs_right margin) in N by lra.
  replace (s * (thrust_min / B) + (margin - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3)))
    with (s * (thrust_min / B) - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) + margin) in N by ring.
  eapply Rle_trans; [exact N|]. apply Rplus_le_compat; [|lra].
  apply Rmult_le_compat_l; [apply share_nonneg | lra].
Qed.

Lemma ceiling_near : Rabs (s * (thrust_max / B)) <= G -> 0 <= margin ->
  Rabs (ceiling - (s * (thrust_max / B) - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) - margin))
  <= share 6 * (25 / 10 * G + margin) + 10000000000 * tiny.
Proof.
  intros Hend Hm. destruct tiny_size as [H0 H1]. destruct within_sizes as (_ & _ & _ & Hparts).
  assert (M := added _ _ _ _ _ _ _ _ _ dot_near
    (later 0 4 _ 0 0 _ _ ltac:(lia) (Rle_refl _) (exact margin))).
  apply rounded in M; [|lra].
  assert (N := subtracted _ _ _ _ _ _ _ _ _
    (later 2 5 _ _ _ _ _ ltac:(lia) (Rle_refl _) (end_near thrust_max Hend)) M).
  apply rounded in N; [|lra]. destruct N as [_ N]. fold ceiling in N. rewrite (Rabs_right margin) in N by lra.
  replace (s * (thrust_max / B) - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3 + margin))
    with (s * (thrust_max / B) - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) - margin) in N by ring.
  eapply Rle_trans; [exact N|]. apply Rplus_le_compat; [|lra].
  apply Rmult_le_compat_l; [apply share_nonneg | lra].
Qed.

Hypothesis thrust_range : Rabs T <= 11 / 10 * G.
Hypothesis margin_enough : margin_least * G <= margin.

Lemma command_near :
  Rabs (command - B / s * (T + (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3)))
  <= share 6 * (B / s * (26 / 10 * G)) + 100000000000000000 * tiny.
Proof.
  destruct tiny_size as [H0 H1].
  destruct within_sizes as ((Hs & HB & HG) & (Q1 & Q2 & Q3) & (T1 & T2 & T3) & Hparts).
  pose proof part_positive as Hk. pose proof (share_nonneg 6). unfold within, greatest_size in *.
  assert (Hrow : forall Q, Rabs Q <= 10000 -> Rabs (B * Q) <= 1000000000).
  { intros Q HQ. rewrite Rabs_mult, (Rabs_right B) by lra. pose proof (Rabs_pos Q).
    apply Rle_trans with (10000 * 10000); [apply Rmult_le_compat|]; lra. }
  assert (N := added _ _ _ _ _ _ _ _ _
    (part_near B T ltac:(rewrite Rabs_right; lra) ltac:(lra)) (part_near (B * Q_2) t_2 (Hrow _ Q2) ltac:(lra))).
  assert (N' := added _ _ _ _ _ _ _ _ _
    (part_near (B * Q_1) t_1 (Hrow _ Q1) ltac:(lra)) (part_near (B * Q_3) t_3 (Hrow _ Q3) ltac:(lra))).
  apply rounded in N; [|lra]. apply rounded in N'; [|lra].
  apply (added _ _ _ _ _ _ _ _ _ N) in N'. clear N. rename N' into N. apply rounded in N; [|lra].
  destruct N as [_ N]. fold command in N.
  assert (Z : forall z, Rabs (B / s * z) = B / s * Rabs z).
  { intros z. rewrite Rabs_mult, (Rabs_right (B / s)); [reflexivity | lra]. }
  replace (B * (T * (1 / s))) with (B / s * T) in N by (field; lra).
  replace (B * Q_1 * (t_1 * (1 / s))) with (B / s * (Q_1 * t_1)) in N by (field; lra).
  replace (B * Q_2 * (t_2 * (1 / s))) with (B / s * (Q_2 * t_2)) in N by (field; lra).
  replace (B * Q_3 * (t_3 * (1 / s))) with (B / s * (Q_3 * t_3)) in N by (field; lra).
  rewrite !Z in N.
  replace (B / s * (T + (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3)))
    with (B / s * T + B / s * (Q_2 * t_2) + (B / s * (Q_1 * t_1) + B / s * (Q_3 * t_3))) by ring.
  eapply Rle_trans; [exact N|]. apply Rplus_le_compat; [|lra]. apply Rmult_le_compat_l; [assumption|].
  replace (B / s * Rabs T + B / s * Rabs (Q_2 * t_2) + (B / s * Rabs (Q_1 * t_1) + B / s * Rabs (Q_3 * t_3)))
    with (B / s * (Rabs T + (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) + Rabs (Q_3 * t_3)))) by ring.
  apply Rmult_le_compat_l; lra.
Qed.

(** What the margin pays for: the rounding of either end, and the command's. *)
Lemma margin_pays :
  100000000000000000 * tiny
  <= B / s * (margin - (share 6 * (25 / 10 * G + margin) + 10000000000 * tiny) - share 6 * (26 / 10 * G)).
Proof.
  destruct tiny_size as [H0 H1]. destruct within_sizes as ((Hs & HB & HG) & _). unfold greatest_size in *.
  pose proof share_of_six. pose proof (share_nonneg 6). unfold margin_least in *.
  assert (Hk : / 100000000 <= B / s).
  { apply Rmult_le_reg_r with s; [lra|]. replace (B / s * s) with B by (field; lra). lra. }
  assert (Hleft : 10000000000000000000000000 * tiny
    <= margin - (share 6 * (25 / 10 * G + margin) + 10000000000 * tiny) - share 6 * (26 / 10 * G)).
  { assert (share 6 * (51 / 10 * G + margin) <= 361 / 1000000000 * (51 / 10 * G + margin))
      by (apply Rmult_le_compat_r; lra). lra. }
  apply Rle_trans with (/ 100000000 * (10000000000000000000000000 * tiny)); [lra|].
  apply Rmult_le_compat; lra.
Qed.

Lemma margin_positive : 0 <= margin.
Proof. destruct within_sizes as ((_ & _ & HG) & _). unfold greatest_size, margin_least in *. lra. Qed.

(** A thrust that the rounded floor admits leaves the rotor at its least, at
    least. *)
Theorem rounded_command_at_least : Rabs (s * (thrust_min / B)) <= G ->
  floor <= T -> thrust_min <= command.
Proof.
  intros Hend Hfloor. pose proof (floor_near Hend margin_positive) as N. pose proof command_near as C.
  pose proof margin_pays as P. pose proof part_positive as Hk. destruct within_sizes as ((Hs & HB & _) & _).
  unfold greatest_size in *. apply both_sides in N. apply both_sides in C.
  set (D := Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) in *. set (e := share 6 * (25 / 10 * G + margin) + _) in *.
  assert (HT : B / s * (s * (thrust_min / B) + (margin - e)) <= B / s * (T + D))
    by (apply Rmult_le_compat_l; lra).
  replace (B / s * (s * (thrust_min / B) + (margin - e))) with (thrust_min + B / s * (margin - e)) in HT
    by (field; lra).
  lra.
Qed.

(** One below the rounded ceiling leaves it at its greatest, at most. *)
Theorem rounded_command_at_most : Rabs (s * (thrust_max / B)) <= G ->
  T <= ceiling -> command <= thrust_max.
Proof.
  intros Hend Hceiling. pose proof (ceiling_near Hend margin_positive) as N. pose proof command_near as C.
  pose proof margin_pays as P. pose proof part_positive as Hk. destruct within_sizes as ((Hs & HB & _) & _).
  unfold greatest_size in *. apply both_sides in N. apply both_sides in C.
  set (D := Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) in *. set (e := share 6 * (25 / 10 * G + margin) + _) in *.
  assert (HT : B / s * (T + D) <= B / s * (s * (thrust_max / B) - (margin - e)))
    by (apply Rmult_le_compat_l; lra).
  replace (B / s * (s * (thrust_max / B) - (margin - e))) with (thrust_max - B / s * (margin - e)) in HT
    by (field; lra).
  lra.
Qed.

End Steps.

(** ** Some thrust meets both

    What the exact rows have to leave beside, as a share of the greatest thrust,
    for the rounded floor to be below the rounded ceiling. *)
Definition slack : R := 3 / 1000000.

Lemma slack_pays : forall G margin, / greatest_size <= G -> 0 <= margin <= G ->
  2 * (share 6 * (25 / 10 * G + margin) + 10000000000 * tiny) <= slack * G.
Proof.
  intros G margin HG Hm. destruct tiny_size as [H0 H1]. pose proof share_of_six. pose proof (share_nonneg 6).
  unfold greatest_size, slack in *.
  assert (share 6 * (25 / 10 * G + margin) <= 361 / 1000000000 * (35 / 10 * G)) by (apply Rmult_le_compat; lra).
  lra.
Qed.

Section Together.

Variables (s margin t_1 t_2 t_3 G B Q_1 Q_2 Q_3 thrust_min : R).
Hypothesis rotors_sizes : sizes s t_1 t_2 t_3 B Q_1 Q_2 Q_3 G.
Hypothesis least_end : Rabs (s * (thrust_min / B)) <= G.
Hypothesis margin_range : 0 <= margin <= G.

(** One rotor's floor and another's ceiling. *)
Theorem rounded_floor_below_ceiling : forall B' Q_1' Q_2' Q_3' thrust_max,
  sizes s t_1 t_2 t_3 B' Q_1' Q_2' Q_3' G -> Rabs (s * (thrust_max / B')) <= G ->
  s * (thrust_min / B) - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) + margin + slack * G
  <= s * (thrust_max / B') - (Q_1' * t_1 + Q_2' * t_2 + Q_3' * t_3) - margin ->
  floor s margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min <= ceiling s margin t_1 t_2 t_3 B' Q_1' Q_2' Q_3' thrust_max.
Proof.
  intros B' Q_1' Q_2' Q_3' thrust_max Hsizes Hmost H.
  pose proof (floor_near s margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min G rotors_sizes least_end
    (proj1 margin_range)) as N.
  pose proof (ceiling_near s margin t_1 t_2 t_3 B' Q_1' Q_2' Q_3' thrust_max G Hsizes Hmost
    (proj1 margin_range)) as C.
  destruct rotors_sizes as ((_ & _ & HG) & _). pose proof (slack_pays G margin (proj1 HG) margin_range).
  apply both_sides in N. apply both_sides in C. lra.
Qed.

(** One rotor's floor and T_max. *)
Theorem rounded_floor_below_limit : forall T_max,
  s * (thrust_min / B) - (Q_1 * t_1 + Q_2 * t_2 + Q_3 * t_3) + margin + slack * G <= T_max ->
  floor s margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min <= T_max.
Proof.
  intros T_max H.
  pose proof (floor_near s margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min G rotors_sizes least_end
    (proj1 margin_range)) as N.
  destruct rotors_sizes as ((_ & _ & HG) & _). pose proof (slack_pays G margin (proj1 HG) margin_range).
  pose proof share_of_six. pose proof (share_nonneg 6). destruct tiny_size as [Htiny Hsmall].
  apply both_sides in N. assert (0 <= share 6 * (25 / 10 * G + margin)).
  { apply Rmult_le_pos; [assumption|]. unfold greatest_size in *. lra. } lra.
Qed.

End Together.

(** So T, as the code forms it of all rotors' floors and ceilings, meets all of
    them: the greater and the lesser of two numbers round nothing. *)
Theorem thrust_meets_all : forall (floors ceilings : list R) margin T_max wanted,
  (forall f, In f floors -> f <= T_max) -> (forall f c, In f floors -> In c ceilings -> f <= c) ->
  let T := Rmin (Rmax wanted (fold_right Rmax margin floors)) (fold_right Rmin T_max ceilings) in
  (forall f, In f floors -> f <= T) /\ (forall c, In c ceilings -> T <= c).
Proof.
  intros floors ceilings margin T_max wanted Hmax Hboth T.
  assert (Hfloors : forall f, In f floors -> f <= fold_right Rmax margin floors).
  { clear. induction floors as [|g rest IH]; cbn; intros f [].
    - subst. apply Rmax_l.
    - eapply Rle_trans; [now apply IH | apply Rmax_r]. }
  assert (Hceilings : forall c, In c ceilings -> fold_right Rmin T_max ceilings <= c).
  { clear. induction ceilings as [|g rest IH]; cbn; intros c [].
    - subst. apply Rmin_l.
    - eapply Rle_trans; [apply Rmin_r | now apply IH]. }
  assert (Hleast : forall m, m <= T_max -> (forall c, In c ceilings -> m <= c) -> m <= fold_right Rmin T_max ceilings).
  { clear. induction ceilings as [|g rest IH]; cbn; intros m Hm H; [exact Hm|].
    apply Rmin_glb; [apply H; now left | apply IH; [exact Hm | intros c Hc; apply H; now right]]. }
  split.
  - intros f Hf. apply Rmin_glb.
    + eapply Rle_trans; [now apply Hfloors | apply Rmax_r].
    + apply Hleast; [now apply Hmax | intros c Hc; now apply Hboth].
  - intros c Hc. eapply Rle_trans; [apply Rmin_r | now apply Hceilings].
Qed.

End Rounding.
