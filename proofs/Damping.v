(** * Damping always has a share

    Claim (e) of section 6 of docs/extended-law.md, in exact arithmetic;
    [share] of controller-core/src/extended/attitude.rs. P and D are the
    potential's and the damping's torques about the tilt's axes, [level] is
    M_all. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

Section Share.

Variables (p_1 p_2 d_1 d_2 level : R).

Definition along : R := p_1 * d_1 + p_2 * d_2.
Definition damping_square : R := d_1 * d_1 + d_2 * d_2.
Definition room : R := level * level - (p_1 * p_1 + p_2 * p_2).
Definition root : R := sqrt (along * along + damping_square * room).

(** lambda, as the code has it. *)
Definition share : R :=
  if Rle_dec (damping_square + 2 * along) room then 1
  else if Rlt_dec 0 along then room / (root + along)
  else (root - along) / damping_square.

(** Row D of the certificate. *)
Hypothesis row_D : 0 < room.

Lemma damping_square_nonneg : 0 <= damping_square.
Proof. unfold damping_square. nra. Qed.

Lemma root_squared : root * root = along * along + damping_square * room.
Proof.
  apply sqrt_def. pose proof damping_square_nonneg. nra.
Qed.

Lemma root_nonneg : 0 <= root.
Proof. apply sqrt_pos. Qed.

Lemma not_whole_means_damping : ~ damping_square + 2 * along <= room -> 0 < damping_square.
Proof.
  intros H. destruct (Rle_lt_or_eq_dec 0 damping_square damping_square_nonneg) as [Hp | He]; [exact Hp|].
  exfalso. apply H. unfold damping_square in He.
  assert (Hsum : Rsqr d_1 + Rsqr d_2 = 0) by (unfold Rsqr; lra).
  destruct (Rplus_sqr_eq_0 d_1 d_2 Hsum) as [H1 H2].
  pose proof row_D. unfold along, damping_square in *. rewrite H1, H2. lra.
Qed.

(** Where damping is not whole, the feedback is at its level, exactly. *)
Lemma share_solves : ~ damping_square + 2 * along <= room ->
  0 < share /\ damping_square * (share * share) + 2 * along * share = room.
Proof.
  intros H. pose proof (not_whole_means_damping H) as Hs.
  pose proof root_squared as Hr. pose proof root_nonneg as Hn.
  assert (Hbig : Rabs along < root).
  { apply Rsqr_incrst_0; [|apply Rabs_pos | exact Hn].
    rewrite <- Rsqr_abs. unfold Rsqr. rewrite Hr. nra. }
  assert (Hlow : - root < along < root).
  { unfold Rabs in Hbig. destruct (Rcase_abs along); lra. }
  unfold share. destruct (Rle_dec (damping_square + 2 * along) room) as [Hle|_]; [contradiction|].
  destruct (Rlt_dec 0 along) as [Ha|Ha].
  - assert (0 < root + along) by lra. split.
    + apply Rmult_lt_0_compat; [exact row_D | now apply Rinv_0_lt_compat].
    + apply Rmult_eq_reg_r with ((root + along) * (root + along)); [|nra].
      replace ((damping_square * (room / (root + along) * (room / (root + along))) +
        2 * along * (room / (root + along))) * ((root + along) * (root + along)))
        with (room * (damping_square * room + 2 * along * (root + along))) by (field; lra).
      replace (damping_square * room) with (root * root - along * along) by lra. ring.
  - assert (0 < root - along) by lra. split.
    + apply Rmult_lt_0_compat; [assumption | now apply Rinv_0_lt_compat].
    + replace (damping_square * ((root - along) / damping_square * ((root - along) / damping_square)) +
        2 * along * ((root - along) / damping_square))
        with ((root * root - along * along) / damping_square) by (field; lra).
      rewrite Hr. field. lra.
Qed.

(** lambda is positive and at most one. *)
Theorem share_positive : 0 < share <= 1.
Proof.
  destruct (Rle_dec (damping_square + 2 * along) room) as [H|H].
  - unfold share. destruct (Rle_dec (damping_square + 2 * along) room); [lra | contradiction].
  - destruct (share_solves H) as [Hp He]. split; [exact Hp|].
    apply Rnot_lt_le. intros Hlt. pose proof row_D as Hroom. pose proof damping_square_nonneg as Hs.
    assert (Hgrow : damping_square * share + 2 * along <= share * (damping_square * share + 2 * along)).
    { assert (0 < damping_square * share + 2 * along).
      { apply Rmult_lt_reg_l with share; [exact Hp|]. rewrite Rmult_0_r. nra. }
      nra. }
    nra.
Qed.

(** The feedback about the tilt's axes keeps its level: |P + lambda D| <= M_all. *)
Theorem feedback_within_level :
  (p_1 + share * d_1) * (p_1 + share * d_1) + (p_2 + share * d_2) * (p_2 + share * d_2) <= level * level.
Proof.
  assert (H : damping_square * (share * share) + 2 * along * share <= room).
  { destruct (Rle_dec (damping_square + 2 * along) room) as [Hle|Hle].
    - unfold share. destruct (Rle_dec (damping_square + 2 * along) room); [lra | contradiction].
    - right. now apply share_solves. }
  unfold damping_square, along, room in H. nra.
Qed.

End Share.
