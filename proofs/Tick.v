(** * A tick's torque keeps the rows

    Section 4 of docs/extended-law.md, put together, in exact arithmetic: from
    the turning that the budget or the reserve allows, over the row of each
    pair of rotors, to every rotor's range. controller-core/src/extended/budget.rs
    has the rows and the budget, controller-core/src/extended/attitude.rs the
    torque. *)

From Coq Require Import Reals Lra List.
From SaturatedHybrid Require Import Allocation Budget.
From SaturatedHybrid Require Limiter.
Open Scope R_scope.

Section Tick.

(** J; the columns of R~, the last of which is b in the axes of the desired
    frame; A, 1.15 Omega, W_max; yaw's feedback and the biases at their levels. *)
Variables (j_1 j_2 j_3 : R) (c_1 c_2 c_3 : torque).
Variables (yaw_acceleration rate yaw_rate feedback_yaw bias_tilt bias_yaw : R).
Hypothesis inertia_positive : 0 < j_1 /\ 0 < j_2 /\ 0 < j_3.
Hypothesis yaw_acceleration_nonneg : 0 <= yaw_acceleration.

Definition inertia_tilt : R := Rmax j_1 j_2.
Definition across : R := Rmax (Rabs (j_1 - j_3)) (Rabs (j_3 - j_2)).

(** What a row's right side loses beforehand. *)
Definition fixed_tilt : R := inertia_tilt * yaw_acceleration + across * product rate yaw_rate.
Definition fixed_yaw : R := j_3 * yaw_acceleration + Rabs (j_1 - j_2) * product rate yaw_rate + feedback_yaw.
Definition room (t y corner range : R) : R :=
  range - corner * bias_tilt - y * (fixed_yaw + bias_yaw) - t * fixed_tilt.

(** R~^T v, and J v. *)
Definition turned_back (v : torque) : torque :=
  {| about_x := dot c_1 v; about_y := dot c_2 v; about_z := dot c_3 v |}.
Definition with_inertia (v : torque) : torque :=
  {| about_x := j_1 * about_x v; about_y := j_2 * about_y v; about_z := j_3 * about_z v |}.

(** R~ is a rotation: it keeps lengths. *)
Hypothesis keeps_lengths : forall v, dot (turned_back v) (turned_back v) = dot v v.

(** The torque: its feedback, J R~^T omega_d', the gyroscopic torque of R~^T
    omega_d, and the bias. *)
Definition turned_gyroscopic (omega : torque) : torque :=
  gyroscopic j_1 j_2 j_3 (about_x (turned_back omega)) (about_y (turned_back omega)) (about_z (turned_back omega)).
Definition tick_torque (feedback omega omega_1 bias : torque) : torque :=
  plus (plus (plus feedback (with_inertia (turned_back omega_1))) (turned_gyroscopic omega)) bias.

Lemma dot_self : forall v, dot v v = tilt_length v * tilt_length v + about_z v * about_z v.
Proof. intros v. rewrite tilt_squared. unfold dot. ring. Qed.

Lemma squares_grow : forall a c, Rabs a <= c -> a * a <= c * c.
Proof. intros a c H. apply abs_bounds in H. nra. Qed.

(** How the frame turns, as the torque for it counts: J_max (|omega_d12'| + A)
    about the tilt's axes, J_33 (|omega_d12'| sin + A) about z. *)
Theorem torque_of_turning : forall omega_1 turn sine,
  tilt_length omega_1 <= turn -> Rabs (about_z omega_1) <= yaw_acceleration -> tilt_length c_3 <= sine ->
  tilt_length (with_inertia (turned_back omega_1)) <= inertia_tilt * (turn + yaw_acceleration)
  /\ Rabs (about_z (with_inertia (turned_back omega_1))) <= j_3 * (turn * sine + yaw_acceleration).
Proof.
  intros omega_1 turn sine Hturn Hyaw Hsine.
  pose proof (tilt_length_nonneg omega_1) as H0. pose proof (Rmax_l j_1 j_2) as Hj1. pose proof (Rmax_r j_1 j_2) as Hj2.
  fold inertia_tilt in Hj1, Hj2. pose proof (squares_grow _ _ Hyaw) as Hyy.
  pose proof (keeps_lengths omega_1) as Hlen. rewrite (dot_self omega_1) in Hlen.
  destruct inertia_positive as (Hp1 & Hp2 & Hp3). split.
  - apply Rsqr_incr_0_var; [|apply Rmult_le_pos; lra]. unfold Rsqr. rewrite tilt_squared.
    unfold with_inertia. cbn [about_x about_y]. unfold dot at 1 in Hlen.
    set (a := about_x (turned_back omega_1)) in *. set (d := about_y (turned_back omega_1)) in *.
    pose proof (Rle_0_sqr (about_z (turned_back omega_1))) as Hz. unfold Rsqr in Hz.
    assert (Haa : 0 <= a * a) by apply Rle_0_sqr. assert (Hdd : 0 <= d * d) by apply Rle_0_sqr.
    assert (tilt_length omega_1 * tilt_length omega_1 <= turn * turn) by (apply Rmult_le_compat; lra).
    assert (Hsum : a * a + d * d <= (turn + yaw_acceleration) * (turn + yaw_acceleration)).
    { assert (0 <= turn * yaw_acceleration) by (apply Rmult_le_pos; lra). lra. }
    apply Rle_trans with (inertia_tilt * inertia_tilt * (a * a + d * d)).
    + assert (j_1 * j_1 * (a * a) <= inertia_tilt * inertia_tilt * (a * a))
        by (apply Rmult_le_compat_r; [exact Haa | apply Rmult_le_compat; lra]).
      assert (j_2 * j_2 * (d * d) <= inertia_tilt * inertia_tilt * (d * d))
        by (apply Rmult_le_compat_r; [exact Hdd | apply Rmult_le_compat; lra]). lra.
    + replace (inertia_tilt * (turn + yaw_acceleration) * (inertia_tilt * (turn + yaw_acceleration)))
        with (inertia_tilt * inertia_tilt * ((turn + yaw_acceleration) * (turn + yaw_acceleration))) by ring.
      apply Rmult_le_compat_l; [apply Rle_0_sqr | exact Hsum].
  - unfold with_inertia, turned_back. cbn [about_z]. rewrite Rabs_mult, (Rabs_right j_3) by lra.
    apply Rmult_le_compat_l; [lra|].
    assert (Hc : Rabs (about_z c_3) <= 1).
    { pose proof (keeps_lengths {| about_x := 0; about_y := 0; about_z := 1 |}) as Hk.
      unfold turned_back, dot in Hk. cbn in Hk.
      apply Rsqr_incr_0_var; [|lra]. unfold Rsqr.
      rewrite <- Rabs_mult, Rabs_pos_eq by apply Rle_0_sqr.
      pose proof (Rle_0_sqr (about_z c_1)) as Hz1. pose proof (Rle_0_sqr (about_z c_2)) as Hz2. unfold Rsqr in *.
      lra. }
    pose proof (dot_bound c_3 omega_1 sine 1 Hsine Hc) as Hdot. pose proof (tilt_length_nonneg c_3).
    assert (sine * tilt_length omega_1 <= sine * turn) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(** The gyroscopic torque, as it counts. *)
Theorem torque_of_rates : forall omega,
  tilt_length omega <= rate -> Rabs (about_z omega) <= yaw_rate ->
  tilt_length (turned_gyroscopic omega) <= across * product rate yaw_rate
  /\ Rabs (about_z (turned_gyroscopic omega)) <= Rabs (j_1 - j_2) * product rate yaw_rate.
Proof.
  intros omega Hr Hw. apply gyroscopic_bound; [apply Rmax_r | apply Rmax_l |].
  pose proof (keeps_lengths omega) as Hlen. rewrite (dot_self omega) in Hlen. unfold dot at 1 in Hlen. rewrite Hlen.
  pose proof (tilt_length_nonneg omega). apply squares_grow in Hw.
  assert (tilt_length omega * tilt_length omega <= rate * rate) by (apply Rmult_le_compat; lra). lra.
Qed.

(** A tick: the tilt's feedback and its level, the sine, the budget alpha and
    the reserve. *)
Variables (feedback omega omega_1 bias : torque) (feedback_tilt feedback_max sine alpha reserve : R).
Hypothesis feedback_within : tilt_length feedback <= feedback_tilt <= feedback_max.
Hypothesis feedback_yaw_within : Rabs (about_z feedback) <= feedback_yaw.
Hypothesis rate_within : tilt_length omega <= rate.
Hypothesis yaw_rate_within : Rabs (about_z omega) <= yaw_rate.
Hypothesis turn_within : tilt_length omega_1 <= Rmax alpha reserve.
Hypothesis yaw_acceleration_within : Rabs (about_z omega_1) <= yaw_acceleration.
Hypothesis bias_within :
  Rabs (about_x bias) <= bias_tilt /\ Rabs (about_y bias) <= bias_tilt /\ Rabs (about_z bias) <= bias_yaw.
Hypothesis sine_covers : tilt_length c_3 <= sine <= 1.
Hypothesis reserve_nonneg : 0 <= reserve.

(** What alpha keeps to, in each row: the tick spends no more than [spent] of
    the room. *)
Definition within_budget (t y spent : R) : Prop :=
  alpha * (t * inertia_tilt + y * (j_3 * sine)) <= spent - t * feedback_tilt.
(** The certificate's row. *)
Definition reserved (t y room : R) : Prop :=
  t * (feedback_max + inertia_tilt * reserve) + y * j_3 * reserve <= room.

(** The row for one direction [beta] of torque. *)
Theorem a_tick_keeps_a_row : forall beta t y corner range spent,
  tilt_length beta <= t -> Rabs (about_z beta) <= y -> Rabs (about_x beta) + Rabs (about_y beta) <= corner ->
  within_budget t y spent -> spent <= room t y corner range -> reserved t y (room t y corner range) ->
  Rabs (dot beta (tick_torque feedback omega omega_1 bias)) <= range.
Proof.
  intros beta t y corner range spent Ht Hy Hc Hbudget Hspent Hreserved.
  destruct bias_within as (Hbx & Hby & Hbz). destruct feedback_within as [Hf Hfm].
  destruct sine_covers as [Hs Hs1]. pose proof (tilt_length_nonneg c_3).
  destruct (torque_of_turning omega_1 _ sine turn_within yaw_acceleration_within Hs) as [Htt Hty].
  destruct (torque_of_rates omega rate_within yaw_rate_within) as [Hgt Hgy].
  pose proof (parts_add_up beta feedback (with_inertia (turned_back omega_1)) (turned_gyroscopic omega) bias
    _ _ _ _ _ _ _ _ _ _ _ Ht Hy Hc Hf feedback_yaw_within Htt Hty Hgt Hgy Hbx Hby Hbz) as Hsum.
  eapply Rle_trans; [exact Hsum|].
  assert (Ht0 : 0 <= t) by (pose proof (tilt_length_nonneg beta); lra).
  assert (Hy0 : 0 <= y) by (pose proof (Rabs_pos (about_z beta)); lra).
  assert (Hj : 0 <= inertia_tilt) by (pose proof (Rmax_l j_1 j_2); unfold inertia_tilt; lra).
  assert (Hj3 : 0 <= j_3) by lra.
  assert (Hrow : t * (feedback_tilt + inertia_tilt * Rmax alpha reserve) + y * (j_3 * Rmax alpha reserve * sine)
    <= room t y corner range).
  { unfold Rmax. destruct (Rle_dec alpha reserve).
    - apply (Limiter.reserve_keeps_the_row t y _ feedback_tilt feedback_max); try assumption; lra.
    - eapply Rle_trans; [|exact Hspent]. now apply Limiter.budget_keeps_the_row. }
  unfold room, fixed_tilt, fixed_yaw in Hrow. lra.
Qed.

(** A row that another one covers need not be asked: it costs no more of its
    room. *)
Theorem covered_row_holds : forall t y room_1 t' y' room_2 tilt yaw,
  t' * room_1 <= t * room_2 -> y' * room_1 <= y * room_2 -> 0 <= tilt -> 0 <= yaw -> 0 < room_1 -> 0 <= room_2 ->
  t * tilt + y * yaw <= room_1 -> t' * tilt + y' * yaw <= room_2.
Proof.
  intros t y room_1 t' y' room_2 tilt yaw Ht Hy Htilt Hyaw H1 H2 H.
  apply Rmult_le_reg_r with room_1; [exact H1|].
  assert (t' * room_1 * tilt <= t * room_2 * tilt) by (apply Rmult_le_compat_r; lra).
  assert (y' * room_1 * yaw <= y * room_2 * yaw) by (apply Rmult_le_compat_r; lra).
  assert ((t * tilt + y * yaw) * room_2 <= room_1 * room_2) by (apply Rmult_le_compat_r; lra). lra.
Qed.

(** Of rotors: the row of two at their ends at once, with [t], [y] and [corner]
    of all differences, and the thrust floor's, with those of each. *)
Variables (s_lo s_hi margin T_max : R) (rotors : list rotor) (range_top range_bottom : R).
Variables (t y corner spent t_floor y_floor corner_floor spent_floor : R).
Hypothesis differences : forall r r', In r rotors -> In r' rotors -> let beta := minus (beta r) (beta r') in
  tilt_length beta <= t /\ Rabs (about_z beta) <= y /\ Rabs (about_x beta) + Rabs (about_y beta) <= corner.
Hypothesis each : forall r, In r rotors ->
  tilt_length (beta r) <= t_floor /\ Rabs (about_z (beta r)) <= y_floor
  /\ Rabs (about_x (beta r)) + Rabs (about_y (beta r)) <= corner_floor.

Definition kept (t y corner spent range : R) : Prop :=
  within_budget t y spent /\ spent <= room t y corner range /\ reserved t y (room t y corner range).

Theorem a_tick_keeps_the_rows :
  kept t y corner spent (range_top - range_bottom - 2 * margin) ->
  kept t_floor y_floor corner_floor spent_floor (T_max - range_bottom - 2 * margin) ->
  rows_hold margin T_max rotors range_top range_bottom (tick_torque feedback omega omega_1 bias).
Proof.
  intros (Hb & Hs & Hr) (Hb' & Hs' & Hr'). split.
  - intros r r' Hin Hin'. destruct (differences r r' Hin Hin') as (H1 & H2 & H3).
    now apply (a_tick_keeps_a_row _ t y corner _ spent).
  - intros r Hin. destruct (each r Hin) as (H1 & H2 & H3).
    now apply (a_tick_keeps_a_row _ t_floor y_floor corner_floor _ spent_floor).
Qed.

(** So whatever thrust is wanted, no tick takes a rotor out of its range. *)
Theorem a_tick_keeps_rotors_in_range : forall s wanted,
  (forall r, In r rotors -> 0 < b r) -> (forall r, In r rotors -> 0 <= least r /\ 0 <= greatest r) ->
  (forall r, In r rotors -> range_top <= s_lo * greatest r / b r) ->
  (forall r, In r rotors -> s_hi * least r / b r <= range_bottom) -> 0 <= margin -> s_lo <= s <= s_hi ->
  kept t y corner spent (range_top - range_bottom - 2 * margin) ->
  kept t_floor y_floor corner_floor spent_floor (T_max - range_bottom - 2 * margin) ->
  let tau := tick_torque feedback omega omega_1 bias in
  forall r, In r rotors ->
    s * least r + b r * margin <= command r (thrust s margin T_max rotors tau wanted) tau
    <= s * greatest r - b r * margin.
Proof.
  intros s wanted Hb Hranges Htop Hbottom Hmargin Hs H H' tau r Hr.
  refine (proj1 (no_rotor_beyond_its_range s_lo s_hi margin T_max rotors range_top range_bottom
    Hb Hranges Htop Hbottom Hmargin s tau wanted Hs _ r Hr)).
  now apply a_tick_keeps_the_rows.
Qed.

End Tick.
