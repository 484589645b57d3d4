(** * The parts of a torque add up to a row

    Section 4 of docs/extended-law.md, in exact arithmetic;
    controller-core/src/extended/budget.rs. The law's torque is its feedback,
    J R~^T omega_d', a gyroscopic torque and the bias; a row counts each at its
    greatest. *)

From Coq Require Import Reals Lra.
From SaturatedHybrid Require Import Allocation.
Open Scope R_scope.

Definition plus (u v : torque) : torque :=
  {| about_x := about_x u + about_x v;
     about_y := about_y u + about_y v;
     about_z := about_z u + about_z v |}.

Lemma tilt_squared : forall v, tilt_length v * tilt_length v = about_x v * about_x v + about_y v * about_y v.
Proof.
  intros v. apply sqrt_def. pose proof (Rle_0_sqr (about_x v)). pose proof (Rle_0_sqr (about_y v)).
  unfold Rsqr in *. lra.
Qed.

Lemma tilt_triangle : forall u v, tilt_length (plus u v) <= tilt_length u + tilt_length v.
Proof.
  intros u v. pose proof (tilt_length_nonneg u). pose proof (tilt_length_nonneg v).
  pose proof (tilt_squared u). pose proof (tilt_squared v).
  pose proof (tilt_dot u v) as Hd. apply abs_bounds in Hd.
  apply Rsqr_incr_0_var; [|lra]. unfold Rsqr. rewrite tilt_squared. cbn. lra.
Qed.

(** The gyroscopic torque of a frame that turns with r = R~^T omega_d, in the
    body's axes: (J_3 - J_2) r_2 r_3 and so on. R~ mixes tilting and yaw, so only
    |r| is known: |r|^2 is at most the greatest |omega_d12|^2 and omega_d3^2
    together. Products of two components are at most half of that: [product]. *)
Definition gyroscopic (j_1 j_2 j_3 r_1 r_2 r_3 : R) : torque :=
  {| about_x := (j_3 - j_2) * r_2 * r_3; about_y := (j_1 - j_3) * r_3 * r_1; about_z := (j_2 - j_1) * r_1 * r_2 |}.
Definition product (rate yaw_rate : R) : R := (rate * rate + yaw_rate * yaw_rate) / 2.

Theorem gyroscopic_bound : forall j_1 j_2 j_3 r_1 r_2 r_3 rate yaw_rate across,
  Rabs (j_3 - j_2) <= across -> Rabs (j_1 - j_3) <= across ->
  r_1 * r_1 + r_2 * r_2 + r_3 * r_3 <= rate * rate + yaw_rate * yaw_rate ->
  tilt_length (gyroscopic j_1 j_2 j_3 r_1 r_2 r_3) <= across * product rate yaw_rate
  /\ Rabs (about_z (gyroscopic j_1 j_2 j_3 r_1 r_2 r_3)) <= Rabs (j_1 - j_2) * product rate yaw_rate.
Proof.
  intros j_1 j_2 j_3 r_1 r_2 r_3 rate yaw_rate across H32 H13 Hr.
  pose proof (Rabs_pos (j_3 - j_2)) as Hpa.
  assert (H1 : 0 <= r_1 * r_1) by apply Rle_0_sqr. assert (H2 : 0 <= r_2 * r_2) by apply Rle_0_sqr.
  assert (H3 : 0 <= r_3 * r_3) by apply Rle_0_sqr.
  assert (Hprod : (r_1 * r_1 + r_2 * r_2 + r_3 * r_3) / 2 <= product rate yaw_rate) by (unfold product; lra).
  split.
  - apply Rsqr_incr_0_var; [|apply Rmult_le_pos; lra]. unfold Rsqr. rewrite tilt_squared. cbn.
    assert (Hsq : forall x, Rabs x <= across -> x * x <= across * across).
    { intros x Hx. replace (x * x) with (Rabs x * Rabs x) by (rewrite <- Rabs_mult; apply Rabs_pos_eq; apply Rle_0_sqr).
      pose proof (Rabs_pos x). apply Rmult_le_compat; lra. }
    pose proof (Hsq _ H32) as Ha. pose proof (Hsq _ H13) as Hb.
    assert (Hsum : (j_3 - j_2) * r_2 * r_3 * ((j_3 - j_2) * r_2 * r_3) + (j_1 - j_3) * r_3 * r_1 * ((j_1 - j_3) * r_3
      * r_1)
      <= across * across * ((r_1 * r_1 + r_2 * r_2) * (r_3 * r_3))).
    { assert ((j_3 - j_2) * (j_3 - j_2) * (r_2 * r_2 * (r_3 * r_3)) <= across * across * (r_2 * r_2 * (r_3 * r_3)))
        by (apply Rmult_le_compat_r; [now apply Rmult_le_pos | exact Ha]).
      assert ((j_1 - j_3) * (j_1 - j_3) * (r_1 * r_1 * (r_3 * r_3)) <= across * across * (r_1 * r_1 * (r_3 * r_3)))
        by (apply Rmult_le_compat_r; [now apply Rmult_le_pos | exact Hb]). lra. }
    assert (Hmean : (r_1 * r_1 + r_2 * r_2) * (r_3 * r_3) <= product rate yaw_rate * product rate yaw_rate).
    { apply Rle_trans with ((r_1 * r_1 + r_2 * r_2 + r_3 * r_3) / 2 * ((r_1 * r_1 + r_2 * r_2 + r_3 * r_3) / 2)).
      - pose proof (Rle_0_sqr (r_1 * r_1 + r_2 * r_2 - r_3 * r_3)) as Hq. unfold Rsqr in Hq. lra.
      - apply Rmult_le_compat; lra. }
    assert (across * across * ((r_1 * r_1 + r_2 * r_2) * (r_3 * r_3))
      <= across * across * (product rate yaw_rate * product rate yaw_rate))
      by (apply Rmult_le_compat_l; [apply Rle_0_sqr | exact Hmean]).
    lra.
  - cbn. rewrite Rmult_assoc, Rabs_mult.
    replace (Rabs (j_2 - j_1)) with (Rabs (j_1 - j_2)) by apply Rabs_minus_sym.
    apply Rmult_le_compat_l; [apply Rabs_pos|].
    pose proof (Rle_0_sqr (r_1 - r_2)) as Hm. pose proof (Rle_0_sqr (r_1 + r_2)) as Hq. unfold Rsqr in *.
    unfold Rabs. destruct (Rcase_abs (r_1 * r_2)); lra.
Qed.

(** |beta . tau| for a torque of these parts: the left side of a row, and what
    is subtracted from its right side beforehand. *)
Theorem parts_add_up : forall beta feedback turning gyro bias
    t y corner feedback_tilt feedback_yaw turning_tilt turning_yaw gyro_tilt gyro_yaw bias_tilt bias_yaw,
  tilt_length beta <= t -> Rabs (about_z beta) <= y -> Rabs (about_x beta) + Rabs (about_y beta) <= corner ->
  tilt_length feedback <= feedback_tilt -> Rabs (about_z feedback) <= feedback_yaw ->
  tilt_length turning <= turning_tilt -> Rabs (about_z turning) <= turning_yaw ->
  tilt_length gyro <= gyro_tilt -> Rabs (about_z gyro) <= gyro_yaw ->
  Rabs (about_x bias) <= bias_tilt -> Rabs (about_y bias) <= bias_tilt -> Rabs (about_z bias) <= bias_yaw ->
  Rabs (dot beta (plus (plus (plus feedback turning) gyro) bias))
  <= t * (feedback_tilt + turning_tilt + gyro_tilt) + y * (feedback_yaw + turning_yaw + gyro_yaw)
     + corner * bias_tilt + y * bias_yaw.
Proof.
  intros beta feedback turning gyro bias t y corner ft fy tt ty gt gy bt bw
    Ht Hy Hc Hft Hfy Htt Hty Hgt Hgy Hbx Hby Hbz.
  assert (Hsplit : dot beta (plus (plus (plus feedback turning) gyro) bias)
    = dot beta (plus (plus feedback turning) gyro) + dot beta bias) by (unfold dot, plus; cbn; ring).
  rewrite Hsplit. eapply Rle_trans; [apply Rabs_triang|].
  assert (Htilt : tilt_length (plus (plus feedback turning) gyro) <= ft + tt + gt).
  { eapply Rle_trans; [apply tilt_triangle|]. pose proof (tilt_triangle feedback turning). lra. }
  assert (Hyaw : Rabs (about_z (plus (plus feedback turning) gyro)) <= fy + ty + gy).
  { cbn. eapply Rle_trans; [apply Rabs_triang|].
    pose proof (Rabs_triang (about_z feedback) (about_z turning)). lra. }
  assert (Ht0 : 0 <= t) by (pose proof (tilt_length_nonneg beta); lra).
  assert (Hy0 : 0 <= y) by (pose proof (Rabs_pos (about_z beta)); lra).
  pose proof (dot_bound beta (plus (plus feedback turning) gyro) t y Ht Hy) as Hdot.
  assert (t * tilt_length (plus (plus feedback turning) gyro) <= t * (ft + tt + gt)) by (now apply Rmult_le_compat_l).
  assert (y * Rabs (about_z (plus (plus feedback turning) gyro)) <= y * (fy + ty + gy)) by (now apply
    Rmult_le_compat_l).
  assert (Hbias : Rabs (dot beta bias) <= corner * bt + y * bw).
  { unfold dot. eapply Rle_trans; [apply Rabs_triang|].
    assert (Rabs (about_z beta * about_z bias) <= y * bw).
    { rewrite Rabs_mult. apply Rmult_le_compat; try apply Rabs_pos; assumption. }
    assert (Rabs (about_x beta * about_x bias + about_y beta * about_y bias) <= corner * bt).
    { eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult.
      pose proof (Rabs_pos (about_x beta)). pose proof (Rabs_pos (about_y beta)). pose proof (Rabs_pos (about_x bias)).
      assert (Rabs (about_x beta) * Rabs (about_x bias) <= Rabs (about_x beta) * bt) by (apply Rmult_le_compat_l;
        assumption).
      assert (Rabs (about_y beta) * Rabs (about_y bias) <= Rabs (about_y beta) * bt) by (apply Rmult_le_compat_l;
        assumption).
      assert ((Rabs (about_x beta) + Rabs (about_y beta)) * bt <= corner * bt) by (apply Rmult_le_compat_r; lra). lra. }
    lra. }
  lra.
Qed.
