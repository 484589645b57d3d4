(** * Rounding takes no rotor out of its range

    From a wanted thrust and yaw torque to a rotor's command in single precision,
    step by step as the code rounds: controller-core/src/extended/thrust_range.rs
    ([floor], [ceiling], [left]), the caller's division by the thrust scale, and
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

(** The margin of the thrust floor, as a share of [size_of]. The constructor asks
    for a little more, Extended::FLOOR_MARGIN_SHARE_MIN. *)
Definition margin_least : R := 35 / 10000000.

(** What the sizes are shares of, N: the greatest thrust of all rotors, but no
    less than half of what the tilt's torque moves them by in two parts. *)
Definition size_of (thrust parts : R) : R := Rmax thrust (/ 2 * parts).

Section Rounding.

Variable rnd : R -> R.
Hypothesis rnd_close : forall x, Rabs (rnd x - x) <= unit * Rabs x + tiny.
Let rounded := Near.rounded rnd rnd_close.

Section Steps.

(** The thrust scale, the thrust, the torque; a rotor's row of B+ over (T, tau),
    which is B (1, Q_1, Q_2, Q_3); the ends of its range. *)
Variables (s T margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min thrust_max : R).

(** Of the tilt's torque alone, and what is left for yaw beside T at an end of the
    range, with the margin added or subtracted. *)
Definition dot : R :=
  rnd (rnd (rnd (rnd Q_1 * t_1) + rnd (rnd Q_2 * t_2)) + rnd (rnd Q_3 * 0)).
Definition floor : R := rnd (rnd (s * rnd (thrust_min / B)) + rnd (margin - dot)).
Definition ceiling : R := rnd (rnd (s * rnd (thrust_max / B)) - rnd (dot + margin)).
Definition left (end_of_range apart : R) : R :=
  rnd (rnd (rnd (s * rnd (end_of_range / B)) + apart) - rnd (T + dot)).
Definition inverse : R := rnd (1 / s).
Definition part (row asked : R) : R := rnd (rnd row * rnd (asked * inverse)).
Definition command : R :=
  rnd (rnd (part B T + part (B * Q_2) t_2) + rnd (part (B * Q_1) t_1 + part (B * Q_3) t_3)).

(** The torque about z that yaw gets: between the ends that a rotor leaves, or
    nearer to zero. *)
Definition end_at (end_of_range apart : R) : R := rnd (left end_of_range apart / rnd Q_3).
Definition between_ends : Prop :=
  (0 < rnd Q_3 -> Rmin (end_at thrust_min margin) 0 <= t_3 <= Rmax (end_at thrust_max (- margin)) 0)
  /\ (rnd Q_3 < 0 -> Rmin (end_at thrust_max (- margin)) 0 <= t_3 <= Rmax (end_at thrust_min margin) 0).

Variable G : R.
Definition within (x : R) : Prop := Rabs x <= greatest_size.
Definition sizes : Prop :=
  (/ greatest_size <= s <= greatest_size /\ / greatest_size <= B <= greatest_size
   /\ / greatest_size <= G <= greatest_size)
  /\ (within Q_1 /\ within Q_2 /\ within Q_3) /\ (within t_1 /\ within t_2 /\ within t_3)
  /\ Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2) <= 2 * G.
Hypothesis within_sizes : sizes.

(** D, exactly. *)
Let D := Q_1 * t_1 + Q_2 * t_2.

Ltac sizes := destruct tiny_size as [H0 H1]; destruct within_sizes as
  ((Hs & HB & HG) & (Q1 & Q2 & Q3) & (T1 & T2 & T3) & Hparts); unfold within, greatest_size in *;
  pose proof share_of_six; pose proof (share_nonneg 6).

Lemma part_positive : / 100000000 <= B / s.
Proof.
  sizes. apply Rmult_le_reg_r with s; [lra|]. replace (B / s * s) with B by (field; lra). lra.
Qed.

Lemma constant_near : forall x, near 1 (Rabs x) tiny x (rnd x).
Proof.
  intros x. apply (later 1 1 _ (2 * 0 + tiny)); [lia | lra|]. apply rounded; [lra | apply exact].
Qed.

Lemma dot_near : near 4 (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2)) (2000000 * tiny) D dot.
Proof.
  sizes.
  assert (P : forall Q t, Rabs Q <= 10000 -> Rabs t <= 10000 ->
    near 2 (Rabs (Q * t)) (100000 * tiny) (Q * t) (rnd (rnd Q * t))).
  { intros Q t HQ Ht. apply (later 2 2 _ (2 * (3 * 10000 * (tiny + 0)) + tiny)); [lia | lra|].
    apply rounded; [lra|]. change 1%nat with (1 + 0)%nat.
    apply multiplied; try assumption; try lra; try lia; [apply constant_near | apply exact]. }
  assert (P3 := P Q_3 0 Q3 ltac:(rewrite Rabs_R0; lra)). rewrite Rmult_0_r, Rabs_R0 in P3.
  assert (S12 := added _ _ _ _ _ _ _ _ _ (P _ _ Q1 T1) (P _ _ Q2 T2)). apply rounded in S12; [|lra].
  apply (later 2 3 _ _ _ _ _ ltac:(lia) (Rle_refl _)) in P3.
  assert (S := added _ _ _ _ _ _ _ _ _ S12 P3). apply rounded in S; [|lra]. rewrite !Rplus_0_r in S.
  eapply later; [| |exact S]; [lia | lra].
Qed.

Lemma end_near : forall e, 0 <= s * (e / B) <= G ->
  near 2 G (1000000000 * tiny) (s * (e / B)) (rnd (s * rnd (e / B))).
Proof.
  intros e He. sizes.
  assert (Hsize : 0 <= e / B <= 100000000) by (split; nra).
  assert (N : near 2 (Rabs (s * (e / B))) (1000000000 * tiny) (s * (e / B)) (rnd (s * rnd (e / B)))).
  { apply (later 2 2 _ (2 * (3 * 100000000 * (0 + tiny)) + tiny)); [lia | lra|].
    apply rounded; [lra|]. change 1%nat with (0 + 1)%nat.
    apply multiplied; try lra; try lia; try (rewrite Rabs_right; lra); [apply exact | apply constant_near]. }
  destruct N as [_ N]. rewrite (Rabs_right (s * (e / B))) in N by lra. split; [rewrite Rabs_right; lra|].
  pose proof (share_nonneg 2). assert (share 2 * (s * (e / B)) <= share 2 * G) by (apply Rmult_le_compat_l; lra). lra.
Qed.

Lemma part_near : forall row asked, Rabs row <= 1000000000 -> Rabs asked <= 20000 ->
  near 4 (Rabs (row * (asked * (1 / s)))) (4000000000000000 * tiny) (row * (asked * (1 / s))) (part row asked).
Proof.
  intros row asked Hrow Hasked. sizes.
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

(** What rounding takes of an end. *)
Definition taken (size : R) : R := share 6 * size + 10000000000 * tiny.

Lemma grown : forall n size size' x y, (n <= 6)%nat -> size <= size' -> near n size (10000000000 * tiny) x y ->
  Rabs (y - x) <= taken size'.
Proof.
  intros n size size' x y Hn Hsize N. apply (later n 6 _ _ _ _ _ Hn (Rle_refl _)) in N. destruct N as [_ N].
  unfold taken. pose proof (share_nonneg 6).
  assert (share 6 * size <= share 6 * size') by (apply Rmult_le_compat_l; lra).
  lra.
Qed.

Hypothesis margin_nonneg : 0 <= margin.

Lemma margin_near : forall n x, Rabs x = margin -> near n margin 0 x x.
Proof. intros n x <-. apply (later 0 n _ 0); [lia | lra | apply exact]. Qed.

Lemma floor_near : 0 <= s * (thrust_min / B) <= G ->
  Rabs (floor - (s * (thrust_min / B) - D + margin)) <= taken (3 * G + margin).
Proof.
  intros Hend. sizes.
  assert (M := subtracted _ _ _ _ _ _ _ _ _ (margin_near 4 margin (Rabs_pos_eq _ margin_nonneg)) dot_near).
  apply rounded in M; [|lra].
  assert (N := added _ _ _ _ _ _ _ _ _
    (later 2 5 _ _ _ _ _ ltac:(lia) (Rle_refl _) (end_near thrust_min Hend)) M).
  apply rounded in N; [|lra]. fold floor in N.
  replace (s * (thrust_min / B) + (margin - D)) with (s * (thrust_min / B) - D + margin) in N by ring.
  eapply grown; [| |eapply later; [| |exact N]]; [apply le_n | lra | lia | lra].
Qed.

Lemma ceiling_near : 0 <= s * (thrust_max / B) <= G ->
  Rabs (ceiling - (s * (thrust_max / B) - D - margin)) <= taken (3 * G + margin).
Proof.
  intros Hend. sizes.
  assert (M := added _ _ _ _ _ _ _ _ _ dot_near (margin_near 4 margin (Rabs_pos_eq _ margin_nonneg))).
  apply rounded in M; [|lra].
  assert (N := subtracted _ _ _ _ _ _ _ _ _
    (later 2 5 _ _ _ _ _ ltac:(lia) (Rle_refl _) (end_near thrust_max Hend)) M).
  apply rounded in N; [|lra]. fold ceiling in N.
  replace (s * (thrust_max / B) - (D + margin)) with (s * (thrust_max / B) - D - margin) in N by ring.
  eapply grown; [| |eapply later; [| |exact N]]; [apply le_n | lra | lia | lra].
Qed.

Hypothesis thrust_range : Rabs T <= 11 / 10 * G.

Lemma left_near : forall e apart, 0 <= s * (e / B) <= G -> Rabs apart = margin ->
  Rabs (left e apart - (s * (e / B) + apart - (T + D))) <= taken (42 / 10 * G + margin).
Proof.
  intros e apart Hend Hm. sizes.
  assert (M := added _ _ _ _ _ _ _ _ _ (end_near e Hend) (margin_near 2 apart Hm)). apply rounded in M; [|lra].
  assert (N := added _ _ _ _ _ _ _ _ _ (later 0 4 _ 0 0 _ _ ltac:(lia) (Rle_refl _) (exact T)) dot_near).
  apply rounded in N; [|lra].
  assert (S := subtracted _ _ _ _ _ _ _ _ _ (later 3 5 _ _ _ _ _ ltac:(lia) (Rle_refl _) M) N).
  apply rounded in S; [|lra]. fold (left e apart) in S.
  eapply grown; [| |eapply later; [| |exact S]]; [apply le_n | lra | lia | lra].
Qed.

Hypothesis margin_enough : margin_least * G <= margin <= G.
Hypothesis least_end : 0 <= s * (thrust_min / B) <= G.
Hypothesis greatest_end : 0 <= s * (thrust_max / B) <= G.

Lemma command_near : Rabs (Q_3 * t_3) <= 11 / 10 * G ->
  Rabs (command - B / s * (T + (D + Q_3 * t_3))) <= share 6 * (B / s * (42 / 10 * G)) + 100000000000000000 * tiny.
Proof.
  intros HZ. sizes. pose proof part_positive as Hk.
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
  replace (B / s * (T + (D + Q_3 * t_3)))
    with (B / s * T + B / s * (Q_2 * t_2) + (B / s * (Q_1 * t_1) + B / s * (Q_3 * t_3))) by (unfold D; ring).
  eapply Rle_trans; [exact N|]. apply Rplus_le_compat; [|lra]. apply Rmult_le_compat_l; [assumption|].
  replace (B / s * Rabs T + B / s * Rabs (Q_2 * t_2) + (B / s * Rabs (Q_1 * t_1) + B / s * Rabs (Q_3 * t_3)))
    with (B / s * (Rabs T + (Rabs (Q_1 * t_1) + Rabs (Q_2 * t_2)) + Rabs (Q_3 * t_3))) by ring.
  apply Rmult_le_compat_l; lra.
Qed.

(** At an end of yaw's the rotor is at its own, nearly. *)
Lemma at_an_end : forall e apart, 0 <= s * (e / B) <= G -> Rabs apart = margin -> rnd Q_3 <> 0 ->
  Rabs (s * (e / B) + apart - (T + D)) <= 105 / 100 * G ->
  Rabs (rnd Q_3 * end_at e apart - (s * (e / B) + apart - (T + D)))
  <= taken (42 / 10 * G + margin) + unit * (11 / 10 * G) + 1000000 * tiny.
Proof.
  intros e apart He Hm Hq Hsize. pose proof (left_near e apart He Hm) as N. sizes. unfold end_at.
  set (q := rnd Q_3) in *. set (l := left e apart) in *. pose proof (rnd_close (l / q)) as R.
  pose proof (rnd_close Q_3) as RQ. fold q in RQ.
  assert (Habs : Rabs q <= 20000).
  { replace q with (Q_3 + (q - Q_3)) by ring. eapply Rle_trans; [apply Rabs_triang|]. unfold unit in *. lra. }
  assert (Hl : Rabs l <= 11 / 10 * G).
  { set (z := s * (e / B) + apart - (T + D)) in *. replace l with (z + (l - z)) by ring.
    eapply Rle_trans; [apply Rabs_triang|]. unfold taken in N.
    assert (share 6 * (42 / 10 * G + margin) <= 361 / 1000000000 * (52 / 10 * G)) by (apply Rmult_le_compat; lra).
    lra. }
  apply Rmult_le_compat_l with (r := Rabs q) in R; [|apply Rabs_pos].
  rewrite <- Rabs_mult in R. replace (q * (rnd (l / q) - l / q)) with (q * rnd (l / q) - l) in R by (field; assumption).
  replace (Rabs q * (unit * Rabs (l / q) + tiny)) with (unit * Rabs l + Rabs q * tiny) in R.
  - set (z := s * (e / B) + apart - (T + D)) in *.
    replace (q * rnd (l / q) - z) with ((q * rnd (l / q) - l) + (l - z)) by ring.
    eapply Rle_trans; [apply Rabs_triang|].
    assert (unit * Rabs l <= unit * (11 / 10 * G)) by (apply Rmult_le_compat_l; [unfold unit|]; lra).
    assert (Rabs q * tiny <= 20000 * tiny) by (apply Rmult_le_compat_r; lra). lra.
  - assert (0 < Rabs q) by now apply Rabs_pos_lt. unfold Rdiv. rewrite Rabs_mult, Rabs_inv. field. lra.
Qed.

(** So with yaw the rotor is within its range, but for what the margin pays. *)
Definition yaw_takes : R := taken (42 / 10 * G + margin) + 3 * unit * (11 / 10 * G) + 2000000 * tiny.

Lemma sum_within : floor <= T <= ceiling -> between_ends ->
  s * (thrust_min / B) + margin - yaw_takes <= T + (D + Q_3 * t_3) <= s * (thrust_max / B) - margin + yaw_takes
  /\ Rabs (Q_3 * t_3) <= 11 / 10 * G.
Proof.
  intros HT [Hpos Hneg]. pose proof (floor_near least_end) as F. pose proof (ceiling_near greatest_end) as C. sizes.
  set (low := s * (thrust_min / B)) in *. set (high := s * (thrust_max / B)) in *.
  assert (Htaken : forall n, 0 <= n <= 52 / 10 * G -> 0 <= taken n <= 19 / 10000000 * G).
  { intros n Hn. unfold taken. assert (0 <= share 6 * n) by (apply Rmult_le_pos; lra).
    assert (share 6 * n <= 361 / 1000000000 * (52 / 10 * G)) by (apply Rmult_le_compat; lra). lra. }
  pose proof (Htaken (3 * G + margin) ltac:(lra)) as Ht3. pose proof (Htaken (42 / 10 * G + margin) ltac:(lra)) as Ht4.
  assert (Hmore : taken (3 * G + margin) <= taken (42 / 10 * G + margin)).
  { unfold taken. apply Rplus_le_compat_r, Rmult_le_compat_l; lra. }
  apply both_sides in F. apply both_sides in C. pose proof least_end as L. pose proof greatest_end as U.
  fold low in L. fold high in U.
  (* Without yaw. *)
  assert (Hbase : low + margin - taken (3 * G + margin) <= T + D <= high - margin + taken (3 * G + margin)) by lra.
  set (q := rnd Q_3) in *. pose proof (rnd_close Q_3) as RQ. fold q in RQ.
  (* What yaw moves the rotor by, with the rounded constant. *)
  assert (Hq : - (105 / 100 * G) <= q * t_3 <= 105 / 100 * G
    /\ low + margin - (taken (42 / 10 * G + margin) + unit * (11 / 10 * G) + 1000000 * tiny) <= T + D + q * t_3
       <= high - margin + (taken (42 / 10 * G + margin) + unit * (11 / 10 * G) + 1000000 * tiny)).
  { assert (Hu : 0 <= unit * (11 / 10 * G)) by (apply Rmult_le_pos; unfold unit; lra).
    assert (Hu1 : unit * (11 / 10 * G) <= 1 / 1000000 * G) by (unfold unit; lra).
    destruct (Req_dec q 0) as [E|Hne]; [rewrite E, Rmult_0_l; lra|].
    pose proof (at_an_end thrust_min margin least_end (Rabs_pos_eq _ margin_nonneg) Hne
      ltac:(apply Rabs_le; fold low; lra)) as A.
    pose proof (at_an_end thrust_max (- margin) greatest_end
      ltac:(rewrite Rabs_Ropp; apply Rabs_pos_eq, margin_nonneg) Hne ltac:(apply Rabs_le; fold high; lra)) as A'.
    fold q low in A. fold q high in A'. apply both_sides in A. apply both_sides in A'.
    destruct (Rdichotomy q 0 Hne) as [Hm|Hp].
    - specialize (Hneg Hm). pose proof (Rmult_le_compat_neg_l q _ _ ltac:(lra) (proj1 Hneg)) as X.
      pose proof (Rmult_le_compat_neg_l q _ _ ltac:(lra) (proj2 Hneg)) as Y.
      unfold Rmin, Rmax in X, Y. destruct (Rle_dec _ _) in X; destruct (Rle_dec _ _) in Y; lra.
    - specialize (Hpos Hp). pose proof (Rmult_le_compat_l q _ _ ltac:(lra) (proj1 Hpos)) as X.
      pose proof (Rmult_le_compat_l q _ _ ltac:(lra) (proj2 Hpos)) as Y.
      unfold Rmin, Rmax in X, Y. destruct (Rle_dec _ _) in X; destruct (Rle_dec _ _) in Y; lra. }
  (* And with the constant itself. *)
  assert (Hz : Rabs (q * t_3 - Q_3 * t_3) <= unit * Rabs (Q_3 * t_3) + 10000 * tiny).
  { replace (q * t_3 - Q_3 * t_3) with ((q - Q_3) * t_3) by ring. rewrite !Rabs_mult.
    pose proof (Rmult_le_compat_r (Rabs t_3) _ _ (Rabs_pos t_3) RQ).
    assert (tiny * Rabs t_3 <= tiny * 10000) by (apply Rmult_le_compat_l; lra). lra. }
  assert (Hsize : Rabs (Q_3 * t_3) <= 11 / 10 * G).
  { destruct Hq as [Hq _]. apply both_sides in Hz. unfold unit in Hz.
    unfold Rabs in Hz |- *. destruct (Rcase_abs _); lra. }
  split; [|exact Hsize]. apply both_sides in Hz.
  assert (unit * Rabs (Q_3 * t_3) <= unit * (11 / 10 * G)) by (apply Rmult_le_compat_l; [unfold unit|]; lra).
  unfold yaw_takes. lra.
Qed.

(** A thrust between the rounded ends and yaw's share of what is left keep the
    rotor's command within its range. *)
Theorem rounded_command_within : floor <= T <= ceiling -> between_ends -> thrust_min <= command <= thrust_max.
Proof.
  intros HT Hends. destruct (sum_within HT Hends) as [Hsum HZ]. pose proof (command_near HZ) as C.
  pose proof part_positive as Hk. sizes. apply both_sides in C. set (sum := T + (D + Q_3 * t_3)) in *.
  (* What the margin pays for. *)
  assert (Hpays : 100000000000000000 * tiny <= B / s * (margin - yaw_takes - share 6 * (42 / 10 * G))).
  { assert (Hleft : 10000000000000000000000000 * tiny <= margin - yaw_takes - share 6 * (42 / 10 * G)).
    { unfold yaw_takes, taken, unit, margin_least in *.
      assert (share 6 * (84 / 10 * G + margin) <= 361 / 1000000000 * (84 / 10 * G + margin))
        by (apply Rmult_le_compat_r; lra). lra. }
    apply Rle_trans with (/ 100000000 * (10000000000000000000000000 * tiny)); [lra|].
    apply Rmult_le_compat; lra. }
  pose proof (Rmult_le_compat_l (B / s) _ _ ltac:(lra) (proj1 Hsum)) as X.
  pose proof (Rmult_le_compat_l (B / s) _ _ ltac:(lra) (proj2 Hsum)) as Y.
  replace (B / s * (s * (thrust_min / B) + margin - yaw_takes)) with (thrust_min + B / s * (margin - yaw_takes)) in X
    by (field; lra).
  replace (B / s * (s * (thrust_max / B) - margin + yaw_takes)) with (thrust_max - B / s * (margin - yaw_takes)) in Y
    by (field; lra).
  lra.
Qed.

End Steps.

(** ** Some thrust meets both

    What the exact rows have to leave beside, as a share of the greatest thrust,
    for the rounded floor to be below the rounded ceiling. *)
Definition slack : R := 3 / 1000000.

Lemma slack_pays : forall G margin, / greatest_size <= G -> 0 <= margin <= G ->
  0 <= 2 * taken (3 * G + margin) <= slack * G.
Proof.
  intros G margin HG Hm. destruct tiny_size as [H0 H1]. pose proof share_of_six. pose proof (share_nonneg 6).
  unfold greatest_size, slack, taken in *.
  assert (0 <= share 6 * (3 * G + margin)) by (apply Rmult_le_pos; lra).
  assert (share 6 * (3 * G + margin) <= 361 / 1000000000 * (4 * G)) by (apply Rmult_le_compat; lra). lra.
Qed.

Section Together.

Variables (s margin t_1 t_2 t_3 G B Q_1 Q_2 Q_3 thrust_min : R).
Hypothesis rotors_sizes : sizes s t_1 t_2 t_3 B Q_1 Q_2 Q_3 G.
Hypothesis least_end : 0 <= s * (thrust_min / B) <= G.
Hypothesis margin_range : 0 <= margin <= G.

(** One rotor's floor and another's ceiling; one rotor's floor and T_max. *)
Theorem rounded_floor_below_ceiling : forall B' Q_1' Q_2' Q_3' thrust_max,
  sizes s t_1 t_2 t_3 B' Q_1' Q_2' Q_3' G -> 0 <= s * (thrust_max / B') <= G ->
  s * (thrust_min / B) - (Q_1 * t_1 + Q_2 * t_2) + margin + slack * G
  <= s * (thrust_max / B') - (Q_1' * t_1 + Q_2' * t_2) - margin ->
  floor s margin t_1 t_2 B Q_1 Q_2 Q_3 thrust_min <= ceiling s margin t_1 t_2 B' Q_1' Q_2' Q_3' thrust_max.
Proof.
  intros B' Q_1' Q_2' Q_3' thrust_max Hsizes Hmost H. destruct margin_range as [Hm _].
  pose proof (floor_near s margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min G rotors_sizes Hm least_end) as N.
  pose proof (ceiling_near s margin t_1 t_2 t_3 B' Q_1' Q_2' Q_3' thrust_max G Hsizes Hm Hmost) as C.
  destruct rotors_sizes as ((_ & _ & HG) & _). pose proof (slack_pays G margin (proj1 HG) margin_range).
  apply both_sides in N. apply both_sides in C. lra.
Qed.

Theorem rounded_floor_below_limit : forall T_max,
  s * (thrust_min / B) - (Q_1 * t_1 + Q_2 * t_2) + margin + slack * G <= T_max ->
  floor s margin t_1 t_2 B Q_1 Q_2 Q_3 thrust_min <= T_max.
Proof.
  intros T_max H. destruct margin_range as [Hm _].
  pose proof (floor_near s margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_min G rotors_sizes Hm least_end) as N.
  destruct rotors_sizes as ((_ & _ & HG) & _). pose proof (slack_pays G margin (proj1 HG) margin_range).
  apply both_sides in N. lra.
Qed.

Theorem rounded_margin_below_ceiling : forall thrust_max, 0 <= s * (thrust_max / B) <= G ->
  margin + slack * G <= s * (thrust_max / B) - (Q_1 * t_1 + Q_2 * t_2) - margin ->
  margin <= ceiling s margin t_1 t_2 B Q_1 Q_2 Q_3 thrust_max.
Proof.
  intros thrust_max Hmost H. destruct margin_range as [Hm _].
  pose proof (ceiling_near s margin t_1 t_2 t_3 B Q_1 Q_2 Q_3 thrust_max G rotors_sizes Hm Hmost) as C.
  destruct rotors_sizes as ((_ & _ & HG) & _). pose proof (slack_pays G margin (proj1 HG) margin_range).
  apply both_sides in C. lra.
Qed.

End Together.

(** So T, as the code forms it of all rotors' floors and ceilings, meets all of
    them; and what yaw gets is between the ends of each, or nearer to zero: the
    greater and the lesser of two numbers round nothing. *)
Lemma greatest_of : forall start l x, In x l -> x <= fold_right Rmax start l.
Proof.
  induction l as [|z rest IH]; cbn; intros x []; [subst; apply Rmax_l|].
  eapply Rle_trans; [now apply IH | apply Rmax_r].
Qed.

Lemma least_of : forall start l x, In x l -> fold_right Rmin start l <= x.
Proof.
  induction l as [|z rest IH]; cbn; intros x []; [subst; apply Rmin_l|].
  eapply Rle_trans; [apply Rmin_r | now apply IH].
Qed.

Theorem thrust_meets_all : forall (floors ceilings : list R) margin T_max beside wanted,
  (forall f, f = margin \/ In f floors -> f <= T_max /\ forall c, In c ceilings -> f <= c) ->
  let most := Rmin (fold_right Rmin T_max ceilings) beside in
  let least := fold_right Rmax margin floors in
  let T := Rmin (Rmax least most) (Rmax least wanted) in
  (forall f, In f floors -> f <= T) /\ T <= T_max /\ forall c, In c ceilings -> T <= c.
Proof.
  intros floors ceilings margin T_max beside wanted H most least T.
  assert (Hleast : forall m, (forall f, f = margin \/ In f floors -> f <= m) -> least <= m).
  { unfold least. clear. intros m. induction floors as [|f rest IH]; cbn; intros H; [apply H; now left|].
    apply Rmax_lub; [apply H; now right; left|]. apply IH. intros g [->|Hg]; apply H; [now left | now right; right]. }
  assert (Hbelow : forall m, least <= m -> fold_right Rmin T_max ceilings <= m -> T <= m).
  { intros m H1 H2. eapply Rle_trans; [apply Rmin_l|]. apply Rmax_lub; [exact H1|].
    eapply Rle_trans; [apply Rmin_l | exact H2]. }
  repeat split.
  - intros f Hf. apply Rle_trans with least; [now apply greatest_of | apply Rmin_glb; apply Rmax_l].
  - apply Hbelow; [apply Hleast; intros f Hf; exact (proj1 (H f Hf))|].
    clear. induction ceilings as [|c rest IH]; cbn; [lra | eapply Rle_trans; [apply Rmin_r | exact IH]].
  - intros c Hc. apply Hbelow; [apply Hleast; intros f Hf; exact (proj2 (H f Hf) c Hc) | now apply least_of].
Qed.

Theorem yaw_meets_all : forall (lows highs : list R) yaw_max wanted,
  let least := Rmin (fold_right Rmax (- yaw_max) lows) 0 in
  let most := Rmax (fold_right Rmin yaw_max highs) 0 in
  let t_3 := Rmin most (Rmax least wanted) in
  (forall low, In low lows -> Rmin low 0 <= t_3) /\ (forall high, In high highs -> t_3 <= Rmax high 0).
Proof.
  intros lows highs yaw_max wanted least most t_3. split.
  - intros low Hl. apply Rle_trans with least; [apply Rle_min_compat_r; now apply greatest_of|].
    apply Rmin_glb; [apply Rle_trans with 0; [apply Rmin_r | apply Rmax_r] | apply Rmax_l].
  - intros high Hh. apply Rle_trans with most; [apply Rmin_l | apply Rle_max_compat_r; now apply least_of].
Qed.

End Rounding.
