(** * The sharp bound at one state

    docs/sharp-bound.md, steps 4 to 6; the header of controller-core/src/
    certificate/sharp.rs and its [velocity], [linear_part], [quadratic_part] and
    [square_of_sum]. [SharpMotion] says that the numbers here are those of the
    frame that flies; [SharpCells] bounds them over a cell.

    gamma is the tilt, theta and phi are pitch and roll, all in cosines and
    sines; n = |u|, m/s^2; omega_1 and omega_2, rad/s, tilt the frame; psi', psi''
    move the heading. (v_x, v_y) are components along body x and y. *)

From Coq Require Import Reals Lra.
From SaturatedHybrid Require Import Space Slope.
Open Scope R_scope.

(** What tilts rho and what turns about it, of omega_d' with u'' and without. *)
Definition square_of_sum (linear_tilting linear_yawing tilting yawing : R) : R :=
  (linear_tilting + tilting) * (linear_tilting + tilting) + (linear_yawing + yawing) * (linear_yawing + yawing).

(** stretch, length, product and mixed are r / n, p / n, p r / n^2 and [p] / n. *)
Definition yaw_bound (tangent secant rate mixed : R) : R := rate * secant + tangent * mixed.
Definition tilting_bound (tangent secant rate length product mixed : R) : R :=
  sqrt (2 * product * (2 * product)
        + length * yaw_bound tangent secant rate mixed * (length * yaw_bound tangent secant rate mixed)).
Definition yawing_bound (tangent sine secant rate acceleration stretch length mixed : R) : R :=
  acceleration * secant + 2 * tangent * stretch * mixed + rate * rate * tangent * tangent
  + 2 * rate * length * sine * secant * secant + length * length * (1 + 2 * tangent * tangent) / 2.

Lemma between : forall v b, Rabs v <= b -> - b <= v <= b.
Proof. intros v b H. unfold Rabs in H. destruct (Rcase_abs v); lra. Qed.

Section State.

Variables (cos_tilt sin_tilt cos_pitch sin_pitch cos_roll sin_roll : R).
Hypothesis tilt_on_circle : cos_tilt * cos_tilt + sin_tilt * sin_tilt = 1.
Hypothesis pitch_on_circle : cos_pitch * cos_pitch + sin_pitch * sin_pitch = 1.
Hypothesis roll_on_circle : cos_roll * cos_roll + sin_roll * sin_roll = 1.
Hypothesis not_flat : 0 < cos_tilt /\ 0 <= sin_tilt /\ 0 < cos_roll.
(** e3 . rho *)
Hypothesis tilt_of_turns : cos_tilt = cos_pitch * cos_roll.

(** sin gamma times m: the uphill direction along body x and y. *)
Definition uphill_x : R := - sin_pitch.
Definition uphill_y : R := cos_pitch * sin_roll.
Definition tangent : R := sin_tilt / cos_tilt.

Lemma uphill_length : plane_length uphill_x uphill_y = sin_tilt.
Proof.
  rewrite <- (sqrt_square sin_tilt) by lra. unfold plane_length. f_equal. unfold uphill_x, uphill_y.
  assert (cos_tilt * cos_tilt = cos_pitch * cos_pitch * (cos_roll * cos_roll)) by (rewrite tilt_of_turns; ring).
  assert (E : cos_pitch * sin_roll * (cos_pitch * sin_roll) = cos_pitch * cos_pitch * (1 - cos_roll * cos_roll)).
  { rewrite <- roll_on_circle. ring. }
  rewrite E. lra.
Qed.

(** [v] = (|v| + |v_perp|) / 2: step 4. sin chi (x . v) is at most that,
    wherever the heading puts chi. v_perp is the part of v across the slope. *)
Theorem mixed_bound : forall v_x v_y perp,
  Rabs (uphill_x * v_y - uphill_y * v_x) <= sin_tilt * perp ->
  Rabs (uphill_y * v_x) <= sin_tilt * ((plane_length v_x v_y + perp) / 2).
Proof.
  intros v_x v_y perp H. pose proof (plane_cauchy_schwarz uphill_y uphill_x v_x v_y) as Hcs.
  assert (E : plane_length uphill_y uphill_x = sin_tilt).
  { rewrite <- uphill_length. unfold plane_length. f_equal. ring. }
  rewrite E in Hcs. apply between in H. apply between in Hcs. apply Rabs_le. lra.
Qed.

(** ** Omega and N: step 5 *)

Variables (omega_1 omega_2 psi_1 psi_2 stretch mixed : R).
Let length : R := plane_length omega_1 omega_2.
Hypothesis turned : Rabs (uphill_y * omega_2) <= sin_tilt * mixed.

Definition omega_3 : R := (psi_1 * cos_pitch - sin_roll * omega_2) / cos_roll.
(** The part of omega_d3' without u''; [along] is r / n with its sign. *)
Definition yawing (along : R) : R :=
  psi_2 * cos_pitch / cos_roll + sin_roll / cos_roll * (2 * along * omega_2)
  + (2 * (psi_1 * psi_1) * sin_pitch * cos_pitch * sin_roll - 2 * psi_1 * sin_pitch * omega_2
     + 2 * psi_1 * cos_pitch * sin_roll * omega_1
     - omega_1 * omega_2 * (1 + sin_roll * sin_roll)) / (cos_roll * cos_roll).

Lemma pitch_positive : 0 < cos_pitch <= 1.
Proof.
  assert (Hpos : 0 < cos_pitch).
  { apply Rmult_lt_reg_r with cos_roll; [lra|]. rewrite <- tilt_of_turns. lra. }
  split; [exact Hpos|]. apply below_by_squares; [lra|]. pose proof (squared sin_pitch). lra.
Qed.

Lemma roll_above_tilt : 0 < / cos_roll <= / cos_tilt.
Proof.
  destruct pitch_positive as (H1 & H2). split; [apply Rinv_0_lt_compat; lra|].
  apply Rinv_le_contravar; [lra|]. rewrite tilt_of_turns.
  apply Rle_trans with (1 * cos_roll); [apply Rmult_le_compat_r|]; lra.
Qed.

(** tan phi = tan gamma sin chi. *)
Lemma roll_tangent : sin_roll / cos_roll = uphill_y / cos_tilt.
Proof. destruct pitch_positive. unfold uphill_y. rewrite tilt_of_turns. field. lra. Qed.

Lemma heading_share : forall rate, Rabs (rate * cos_pitch / cos_roll) <= Rabs rate * / cos_tilt.
Proof.
  intros rate. destruct pitch_positive. destruct roll_above_tilt. unfold Rdiv.
  rewrite !Rabs_mult, (Rabs_pos_eq cos_pitch), (Rabs_pos_eq (/ cos_roll)) by lra.
  rewrite Rmult_assoc. apply Rmult_le_compat_l; [apply Rabs_pos|].
  apply Rle_trans with (1 * / cos_roll); [apply Rmult_le_compat_r|]; lra.
Qed.

Lemma roll_share : forall factor, Rabs (sin_roll / cos_roll * (factor * omega_2)) <= Rabs factor * (tangent * mixed).
Proof.
  intros factor. rewrite roll_tangent. unfold tangent.
  replace (uphill_y / cos_tilt * (factor * omega_2)) with (factor * (/ cos_tilt * (uphill_y * omega_2)))
    by (unfold Rdiv; ring).
  rewrite !Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos|].
  assert (Hc : 0 < / cos_tilt) by (apply Rinv_0_lt_compat; lra).
  rewrite (Rabs_pos_eq (/ cos_tilt)), <- Rabs_mult by lra.
  replace (sin_tilt / cos_tilt * mixed) with (/ cos_tilt * (sin_tilt * mixed)) by (unfold Rdiv; ring).
  apply Rmult_le_compat_l; lra.
Qed.

Theorem yaw_rate_bound : Rabs omega_3 <= yaw_bound tangent (/ cos_tilt) (Rabs psi_1) mixed.
Proof.
  unfold omega_3, yaw_bound.
  replace ((psi_1 * cos_pitch - sin_roll * omega_2) / cos_roll)
    with (psi_1 * cos_pitch / cos_roll + - (sin_roll / cos_roll * (1 * omega_2))) by (field; lra).
  eapply Rle_trans; [apply Rabs_triang|]. rewrite Rabs_Ropp.
  pose proof (heading_share psi_1). pose proof (roll_share 1) as Hroll. rewrite (Rabs_pos_eq 1) in Hroll by lra. lra.
Qed.

(** |N_12|: two orthogonal vectors, exactly. *)
Theorem tilting_part : forall along, Rabs along = stretch ->
  plane_length (- 2 * along * omega_1 + omega_3 * omega_2) (- 2 * along * omega_2 - omega_3 * omega_1)
  = sqrt (2 * (length * stretch) * (2 * (length * stretch)) + length * omega_3 * (length * omega_3)) /\
  sqrt (2 * (length * stretch) * (2 * (length * stretch)) + length * omega_3 * (length * omega_3))
  <= tilting_bound tangent (/ cos_tilt) (Rabs psi_1) length (length * stretch) mixed.
Proof.
  intros along Ha. assert (Haa : along * along = stretch * stretch).
  { rewrite <- Ha, <- Rabs_mult. symmetry. apply Rabs_pos_eq, squared. }
  pose proof (plane_length_squared omega_1 omega_2) as Hl. fold length in Hl.
  split.
  - unfold plane_length. f_equal.
    transitivity ((omega_1 * omega_1 + omega_2 * omega_2) * (4 * (along * along) + omega_3 * omega_3)); [ring|].
    rewrite <- Hl, Haa. ring.
  - unfold tilting_bound. apply sqrt_le_1_alt. apply Rplus_le_compat_l.
    pose proof yaw_rate_bound as Hy. set (b := yaw_bound _ _ _ _) in *.
    replace (length * omega_3 * (length * omega_3)) with (length * length * (Rabs omega_3 * Rabs omega_3))
      by (rewrite <- Rabs_mult, (Rabs_pos_eq (omega_3 * omega_3)) by apply squared; ring).
    replace (length * b * (length * b)) with (length * length * (b * b)) by ring.
    apply Rmult_le_compat_l; [apply squared|]. apply squares_below; [apply Rabs_pos | exact Hy].
Qed.

(** |N_3|, term by term, each at its worst chi. *)
Theorem yawing_part : forall along, Rabs along = stretch ->
  Rabs (yawing along)
  <= yawing_bound tangent sin_tilt (/ cos_tilt) (Rabs psi_1) (Rabs psi_2) stretch length mixed.
Proof.
  intros along Ha. destruct pitch_positive as (Hp & Hp1). destruct roll_above_tilt as (Hr & Hr1).
  pose proof (plane_length_nonneg omega_1 omega_2) as Hl0. fold length in Hl0.
  pose proof (plane_length_squared omega_1 omega_2) as Hl. fold length in Hl.
  assert (Hup : uphill_x * uphill_x + uphill_y * uphill_y = sin_tilt * sin_tilt)
    by (rewrite <- plane_length_squared, uphill_length; reflexivity).
  set (k := / cos_roll) in *. set (s := / cos_tilt) in *.
  assert (Hkk : 0 <= k * k <= s * s) by (split; [apply squared | apply squares_below; lra]).
  (* the heading's acceleration *)
  pose proof (heading_share psi_2) as H1. fold s in H1.
  (* r p *)
  pose proof (roll_share (2 * along)) as H2.
  replace (Rabs (2 * along)) with (2 * stretch) in H2 by (rewrite Rabs_mult, Ha, (Rabs_pos_eq 2) by lra; ring).
  (* psi'^2 *)
  assert (H3 : Rabs (2 * (psi_1 * psi_1) * sin_pitch * cos_pitch * sin_roll * (k * k))
    <= Rabs psi_1 * Rabs psi_1 * tangent * tangent).
  { rewrite <- Rabs_mult, (Rabs_pos_eq (psi_1 * psi_1)) by apply squared.
    replace (2 * (psi_1 * psi_1) * sin_pitch * cos_pitch * sin_roll * (k * k))
      with (psi_1 * psi_1 * ((- 2 * (uphill_x * uphill_y)) * (k * k))) by (unfold uphill_x, uphill_y; ring).
    rewrite Rabs_mult, (Rabs_pos_eq (psi_1 * psi_1)) by apply squared.
    unfold tangent. replace (psi_1 * psi_1 * (sin_tilt / cos_tilt) * (sin_tilt / cos_tilt))
      with (psi_1 * psi_1 * (sin_tilt * sin_tilt * (s * s))) by (unfold s; field; lra).
    apply Rmult_le_compat_l; [apply squared|]. rewrite Rabs_mult, (Rabs_pos_eq (k * k)) by lra.
    apply Rmult_le_compat; try apply Rabs_pos; try lra. rewrite <- Hup.
    pose proof (squared (uphill_x - uphill_y)). pose proof (squared (uphill_x + uphill_y)). apply Rabs_le. lra. }
  (* psi' p *)
  assert (H4 : Rabs ((- 2 * psi_1 * sin_pitch * omega_2 + 2 * psi_1 * cos_pitch * sin_roll * omega_1) * (k * k))
    <= 2 * Rabs psi_1 * length * sin_tilt * s * s).
  { replace (- 2 * psi_1 * sin_pitch * omega_2 + 2 * psi_1 * cos_pitch * sin_roll * omega_1)
      with (2 * psi_1 * (uphill_y * omega_1 + uphill_x * omega_2)) by (unfold uphill_x, uphill_y; ring).
    rewrite !Rabs_mult, (Rabs_pos_eq 2), <- (Rabs_mult k k), (Rabs_pos_eq (k * k)) by lra.
    pose proof (plane_cauchy_schwarz uphill_y uphill_x omega_1 omega_2) as Hcs. fold length in Hcs.
    assert (E : plane_length uphill_y uphill_x = sin_tilt).
    { rewrite <- uphill_length. unfold plane_length. f_equal. ring. }
    rewrite E in Hcs.
    replace (2 * Rabs psi_1 * length * sin_tilt * s * s) with (2 * Rabs psi_1 * (sin_tilt * length) * (s * s)) by ring.
    assert (0 <= 2 * Rabs psi_1) by (pose proof (Rabs_pos psi_1); lra).
    apply Rmult_le_compat; [|lra| |lra].
    - apply Rmult_le_pos; [assumption | apply Rabs_pos].
    - apply Rmult_le_compat_l; assumption. }
  (* p^2 *)
  assert (H5 : Rabs (omega_1 * omega_2 * ((1 + sin_roll * sin_roll) * (k * k)))
    <= length * length * (1 + 2 * tangent * tangent) / 2).
  { assert (Hw : Rabs (omega_1 * omega_2) <= length * length / 2).
    { pose proof (squared (omega_1 - omega_2)). pose proof (squared (omega_1 + omega_2)). apply Rabs_le. lra. }
    assert (E : (1 + sin_roll * sin_roll) * (k * k) = 1 + 2 * (sin_roll / cos_roll * (sin_roll / cos_roll))).
    { transitivity ((cos_roll * cos_roll + 2 * (sin_roll * sin_roll)) * (k * k));
        [rewrite <- roll_on_circle; ring | unfold k; field; lra]. }
    assert (Ht : sin_roll / cos_roll * (sin_roll / cos_roll) <= tangent * tangent).
    { rewrite roll_tangent. unfold tangent, Rdiv.
      replace (uphill_y * / cos_tilt * (uphill_y * / cos_tilt)) with (uphill_y * uphill_y * (s * s)) by (unfold s;
        ring).
      replace (sin_tilt * / cos_tilt * (sin_tilt * / cos_tilt)) with (sin_tilt * sin_tilt * (s * s)) by (unfold s;
        ring).
      apply Rmult_le_compat_r; [apply squared|]. pose proof (squared uphill_x). lra. }
    pose proof (squared (sin_roll / cos_roll)).
    rewrite Rabs_mult, E, (Rabs_pos_eq (1 + _)) by lra.
    replace (length * length * (1 + 2 * tangent * tangent) / 2)
      with (length * length / 2 * (1 + 2 * (tangent * tangent))) by field.
    apply Rmult_le_compat; try apply Rabs_pos; lra. }
  replace (yawing along) with (psi_2 * cos_pitch / cos_roll + sin_roll / cos_roll * (2 * along * omega_2)
    + 2 * (psi_1 * psi_1) * sin_pitch * cos_pitch * sin_roll * (k * k)
    + (- 2 * psi_1 * sin_pitch * omega_2 + 2 * psi_1 * cos_pitch * sin_roll * omega_1) * (k * k)
    - omega_1 * omega_2 * ((1 + sin_roll * sin_roll) * (k * k))) by (unfold yawing, k; field; lra).
  unfold yawing_bound. apply between in H1, H2, H3, H4, H5. apply Rabs_le. lra.
Qed.

(** ** Together: step 6

    w_x / n and w_y / n are body components of u'' over n; [across] bounds the
    part of w / n across the slope. *)

Theorem sharp_bound : forall along w_x w_y across, Rabs along = stretch ->
  Rabs (uphill_x * w_y - uphill_y * w_x) <= sin_tilt * across ->
  let rate_1 := - w_y - 2 * along * omega_1 + omega_3 * omega_2 in
  let rate_2 := w_x - 2 * along * omega_2 - omega_3 * omega_1 in
  let rate_3 := - (sin_roll / cos_roll) * w_x + yawing along in
  rate_1 * rate_1 + rate_2 * rate_2 + rate_3 * rate_3 <=
  square_of_sum (plane_length w_x w_y) (tangent * ((plane_length w_x w_y + across) / 2))
    (tilting_bound tangent (/ cos_tilt) (Rabs psi_1) length (length * stretch) mixed)
    (yawing_bound tangent sin_tilt (/ cos_tilt) (Rabs psi_1) (Rabs psi_2) stretch length mixed).
Proof.
  intros along w_x w_y across Ha Hw rate_1 rate_2 rate_3.
  destruct (tilting_part along Ha) as (T1 & T2). pose proof (yawing_part along Ha) as Y.
  pose proof (mixed_bound w_x w_y across Hw) as Hm.
  assert (HL : Rabs (- (sin_roll / cos_roll) * w_x) <= tangent * ((plane_length w_x w_y + across) / 2)).
  { rewrite roll_tangent. replace (- (uphill_y / cos_tilt) * w_x) with (- (/ cos_tilt * (uphill_y * w_x)))
      by (unfold Rdiv; ring).
    assert (Hc : 0 < / cos_tilt) by (apply Rinv_0_lt_compat; lra).
    rewrite Rabs_Ropp, Rabs_mult, (Rabs_pos_eq (/ cos_tilt)) by lra. unfold tangent.
    replace (sin_tilt / cos_tilt * ((plane_length w_x w_y + across) / 2))
      with (/ cos_tilt * (sin_tilt * ((plane_length w_x w_y + across) / 2))) by (unfold Rdiv; ring).
    apply Rmult_le_compat_l; lra. }
  assert (H12 : plane_length rate_1 rate_2 <= plane_length w_x w_y
    + tilting_bound tangent (/ cos_tilt) (Rabs psi_1) length (length * stretch) mixed).
  { pose proof (plane_triangle (- w_y) w_x (- 2 * along * omega_1 + omega_3 * omega_2)
      (- 2 * along * omega_2 - omega_3 * omega_1)) as H.
    rewrite T1 in H.
    replace (plane_length (- w_y) w_x) with (plane_length w_x w_y) in H by (unfold plane_length; f_equal; ring).
    replace rate_1 with (- w_y + (- 2 * along * omega_1 + omega_3 * omega_2)) by (unfold rate_1; ring).
    replace rate_2 with (w_x + (- 2 * along * omega_2 - omega_3 * omega_1)) by (unfold rate_2; ring). lra. }
  assert (H3 : Rabs rate_3 <= tangent * ((plane_length w_x w_y + across) / 2)
    + yawing_bound tangent sin_tilt (/ cos_tilt) (Rabs psi_1) (Rabs psi_2) stretch length mixed).
  { unfold rate_3. eapply Rle_trans; [apply Rabs_triang | lra]. }
  unfold square_of_sum. apply Rplus_le_compat.
  - rewrite <- plane_length_squared. apply squares_below; [apply plane_length_nonneg | exact H12].
  - replace (rate_3 * rate_3) with (Rabs rate_3 * Rabs rate_3) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
    apply squares_below; [apply Rabs_pos | exact H3].
Qed.

(** omega_d. *)
Theorem sharp_rate_bound :
  omega_1 * omega_1 + omega_2 * omega_2 + omega_3 * omega_3 <=
  length * length + yaw_bound tangent (/ cos_tilt) (Rabs psi_1) mixed
                    * yaw_bound tangent (/ cos_tilt) (Rabs psi_1) mixed.
Proof.
  pose proof (plane_length_squared omega_1 omega_2) as Hl. fold length in Hl. rewrite Hl. apply Rplus_le_compat_l.
  replace (omega_3 * omega_3) with (Rabs omega_3 * Rabs omega_3) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
  apply squares_below; [apply Rabs_pos | apply yaw_rate_bound].
Qed.

End State.
