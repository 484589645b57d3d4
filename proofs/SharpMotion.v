(** * The sharp bound holds along every motion

    The numbers of [SharpBound] are those of the frame that flies: omega_d and
    omega_d' of [DesiredFrame], for a command u, m/s^2, and a heading psi, rad,
    with u', u'', psi' and psi'' at the time t, also where these are derivatives
    from one side only. docs/sharp-bound.md, steps 3 to 6. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Direction DesiredFrame ExactRates Slope SharpBound.
Open Scope R_scope.

(** [yaw_acceleration_exact] of any values at an instant, whether anything moves
    by them or not: there is a motion that does. *)
Theorem yaw_acceleration_of_values : forall (u u_1 : R -> space) (psi psi_1 : R -> R) t u_2 psi_2,
  0 < z (u t) ->
  let n := length (u t) in let r := dot (rho u t) (u_1 t) in
  let w := omega u u_1 (nu psi) (nu_1 psi psi_1) t in
  let c_p := cos_pitch u psi t in let s_p := sin_pitch u psi t in
  let c_r := cos_roll u psi t in let s_r := sin_roll u psi t in
  z (omega_1 u u_1 (nu psi) (nu_1 psi psi_1) t u_2 (nu_2 psi psi_1 t psi_2))
  = psi_2 * c_p / c_r - s_r / c_r * (along_x u psi t u_2 / n - 2 * r / n * y w)
    + (2 * (psi_1 t * psi_1 t) * s_p * c_p * s_r - 2 * psi_1 t * s_p * y w + 2 * psi_1 t * c_p * s_r * x w
       - x w * y w * (1 + s_r * s_r)) / (c_r * c_r).
Proof.
  intros u u_1 psi psi_1 t u_2 psi_2 Hup.
  set (v := fun s => add (u t) (add (scaled (s - t) (u_1 t)) (scaled ((s - t) * (s - t) / 2) u_2))).
  set (v_1 := fun s => add (u_1 t) (scaled (s - t) u_2)).
  set (q := fun s => psi t + ((s - t) * psi_1 t + (s - t) * (s - t) / 2 * psi_2)).
  set (q_1 := fun s => psi_1 t + (s - t) * psi_2).
  assert (Ev : v t = u t) by (unfold v; apply same; components; field).
  assert (Ev1 : v_1 t = u_1 t) by (unfold v_1; apply same; components; ring).
  assert (Eq : q t = psi t) by (unfold q; field).
  assert (Eq1 : q_1 t = psi_1 t) by (unfold q_1; ring).
  assert (Hd : forall a b c : R, is_derive (fun s => a + ((s - t) * b + (s - t) * (s - t) / 2 * c)) t b).
  { intros a b c. auto_derive; [exact I | field]. }
  assert (Hd1 : forall a b : R, is_derive (fun s => a + (s - t) * b) t b).
  { intros a b. auto_derive; [exact I | ring]. }
  assert (M1 : moves v t (v_1 t)) by (rewrite Ev1; exact (conj (Hd _ _ _) (conj (Hd _ _ _) (Hd _ _ _)))).
  assert (M2 : moves v_1 t u_2) by exact (conj (Hd1 _ _) (conj (Hd1 _ _) (Hd1 _ _))).
  assert (M3 : is_derive q t (q_1 t)) by (rewrite Eq1; apply Hd).
  pose proof (yaw_acceleration_exact v v_1 q q_1 t u_2 psi_2 M1 M2 M3 (Hd1 _ _)) as H.
  rewrite Ev in H at 1. specialize (H Hup). revert H.
  clearbody v v_1 q q_1. clear Hd Hd1 M1 M2 M3.
  unfold omega_1, omega, turning, products, upsilon_2, upsilon_1, varpi_2, varpi_1, rho_2, rho_1, along_x, cos_pitch,
    sin_pitch, cos_roll, sin_roll, nu, nu_1, nu_2, upsilon, varpi, rho.
  rewrite Ev, Ev1, Eq, Eq1. exact (fun H => H).
Qed.

Section Motion.

Variables (u u_1 : R -> space) (psi psi_1 : R -> R) (t : R) (u_2 : space) (psi_2 : R).
Hypothesis upwards : 0 < z (u t).

Let omega := omega u u_1 (nu psi) (nu_1 psi psi_1) t.
Let omega_1 := DesiredFrame.omega_1 u u_1 (nu psi) (nu_1 psi psi_1) t u_2 (nu_2 psi psi_1 t psi_2).
Let rho := rho u t.

Definition n : R := length (u t).
(** cos gamma and sin gamma. *)
Definition cos_tilt : R := z (direction (u t)).
Definition sin_tilt : R := plane_length (x (direction (u t))) (y (direction (u t))).
(** The length of the part of v orthogonal to rho, and |v_perp|: the part of v
    that is horizontal and across the slope; zero where there is no slope. *)
Definition tangential (v : space) : R := length (across (u t) v).
Definition within_across (v : space) (perp : R) : Prop :=
  Rabs (y rho * x v - x rho * y v) <= sin_tilt * perp.
(** rho . u' *)
Definition radial : R := dot rho (u_1 t).

Lemma n_positive : 0 < n.
Proof. apply u_length. exact upwards. Qed.

Lemma rho_unit : square rho = 1.
Proof. apply direction_unit, n_positive. Qed.

Lemma tilt_on_circle : cos_tilt * cos_tilt + sin_tilt * sin_tilt = 1.
Proof.
  unfold sin_tilt, cos_tilt. rewrite plane_length_squared. pose proof rho_unit as H.
  unfold rho, DesiredFrame.rho in H. components. lra.
Qed.

(** n is tall where the thrust is tilted: u_z = n cos gamma. *)
Theorem magnitude_of_tilt : n * cos_tilt = z (u t) /\ 0 < cos_tilt.
Proof.
  pose proof n_positive as Hn. unfold cos_tilt, direction, n in *. cbn [z scaled]. split.
  - field. lra.
  - apply Rmult_lt_0_compat; [now apply Rinv_0_lt_compat | exact upwards].
Qed.

(** p^2 + r^2 = |u'|^2, and the same of any vector. *)
Theorem budget_is_shared : forall v, tangential v * tangential v + dot rho v * dot rho v = square v.
Proof.
  intros v. unfold tangential. rewrite length_squared, across_square by apply n_positive.
  change (direction (u t)) with rho. ring.
Qed.

(** In body components. *)
Lemma tangential_in_body : forall v, plane_length (along_x u psi t v) (along_y u psi t v) = tangential v.
Proof.
  intros v. destruct (frame_at_t u u_1 (nu psi) (nu_1 psi psi_1) t upwards (nu_unit psi t)) as (F1 & F2 & F3 & _).
  pose proof (in_a_frame _ _ v v F1 F2 F3) as H. pose proof (budget_is_shared v) as Hb.
  unfold plane_length, along_x, along_y. rewrite <- (sqrt_square (tangential v)) by apply length_nonneg. f_equal.
  unfold square in Hb. unfold rho in Hb. lra.
Qed.

Let cos_pitch := cos_pitch u psi t.
Let sin_pitch := sin_pitch u psi t.
Let cos_roll := cos_roll u psi t.
Let sin_roll := sin_roll u psi t.

Lemma tilt_of_turns : cos_tilt = cos_pitch * cos_roll.
Proof. destruct (three_turns u psi t upwards) as (_ & _ & H). unfold cos_tilt.
  change (direction (u t)) with (DesiredFrame.rho u t). now rewrite H. Qed.

Lemma across_in_body : forall v,
  uphill_x sin_pitch * along_y u psi t v - uphill_y cos_pitch sin_roll * along_x u psi t v
  = y rho * x v - x rho * y v.
Proof.
  intros v. destruct (three_turns u psi t upwards) as (Hu & Hs & Hr).
  pose proof (circle (psi t)) as Hc. pose proof (ExactRates.pitch_on_circle u psi t upwards) as Hp.
  unfold along_x, along_y. rewrite Hs, Hu. unfold rho. rewrite Hr.
  fold cos_pitch sin_pitch in Hp |- *. fold cos_roll sin_roll. unfold uphill_x, uphill_y. components.
  revert Hc Hp. generalize cos_pitch sin_pitch cos_roll sin_roll (cos (psi t)) (sin (psi t)).
  intros c d f e a b Hab Hcd.
  replace (- d * ((a * d * e - b * f) * x v + (b * d * e + a * f) * y v + c * e * z v)
           - c * e * (a * c * x v + b * c * y v + - d * z v))
    with (- (a * e * (c * c + d * d)) * x v - b * e * (c * c + d * d) * y v + b * d * f * x v - a * d * f * y v)
    by ring.
  rewrite Hcd. ring.
Qed.

(** The greatest of a part across the slope: its horizontal part's length. *)
Theorem horizontal_is_across : forall v, within_across v (plane_length (x v) (y v)).
Proof.
  intros v. unfold within_across. pose proof (plane_cauchy_schwarz (y rho) (- x rho) (x v) (y v)) as H.
  replace (y rho * x v + - x rho * y v) with (y rho * x v - x rho * y v) in H by ring.
  replace (plane_length (y rho) (- x rho)) with sin_tilt in H; [exact H|].
  unfold sin_tilt, plane_length. f_equal. unfold rho, DesiredFrame.rho. ring.
Qed.

Theorem tangential_is_across : forall v, within_across v (tangential v).
Proof.
  intros v. unfold within_across, tangential.
  pose proof (cauchy_schwarz {| x := y rho; y := - x rho; z := 0 |} (across (u t) v)) as H.
  replace (dot {| x := y rho; y := - x rho; z := 0 |} (across (u t) v)) with (y rho * x v - x rho * y v) in H.
  - replace (length {| x := y rho; y := - x rho; z := 0 |}) with sin_tilt in H; [exact H|].
    unfold sin_tilt, plane_length, length. f_equal. change (direction (u t)) with rho. components. ring.
  - unfold across. change (direction (u t)) with rho. components. ring.
Qed.

(** omega_d and omega_d' at t. *)
Theorem sharp_bound_of_motion : forall perp_1 perp_2,
  within_across (u_1 t) perp_1 -> within_across u_2 perp_2 ->
  let tan := tangent cos_tilt sin_tilt in let secant := / cos_tilt in
  let p := tangential (u_1 t) in let w := tangential u_2 in let r := Rabs radial in
  let mixed := (p / n + perp_1 / n) / 2 in
  square omega <= p / n * (p / n)
    + yaw_bound tan secant (Rabs (psi_1 t)) mixed * yaw_bound tan secant (Rabs (psi_1 t)) mixed /\
  square omega_1 <= square_of_sum (w / n) (tan * ((w / n + perp_2 / n) / 2))
    (tilting_bound tan secant (Rabs (psi_1 t)) (p / n) (p / n * (r / n)) mixed)
    (yawing_bound tan sin_tilt secant (Rabs (psi_1 t)) (Rabs psi_2) (r / n) (p / n) mixed).
Proof.
  intros perp_1 perp_2 H1 H2 tan secant p w r mixed.
  pose proof n_positive as Hn. assert (Hi : 0 < / n) by (now apply Rinv_0_lt_compat).
  destruct (tilting_exact u u_1 psi psi_1 t u_2 psi_2 upwards) as (E1 & E2 & E3 & E4).
  pose proof (yaw_acceleration_of_values u u_1 psi psi_1 t u_2 psi_2 upwards) as E5.
  pose proof (yaw_rate_exact u u_1 psi psi_1 t upwards) as E6.
  cbv zeta in E1, E2, E3, E4, E5. fold n in E1, E2, E3, E4, E5.
  change (dot (DesiredFrame.rho u t) (u_1 t)) with radial in E3, E4, E5. fold omega in E1, E2, E3, E4, E5, E6.
  fold omega_1 in E3, E4, E5. unfold yaw_rate in E6. fold omega in E6.
  fold cos_pitch sin_pitch cos_roll sin_roll in E5, E6.
  assert (Hover : forall v, plane_length (along_x u psi t v / n) (along_y u psi t v / n) = tangential v / n).
  { intros v. rewrite <- tangential_in_body. apply plane_length_over. exact Hn. }
  assert (Hacross : forall v perp, within_across v perp ->
    Rabs (uphill_x sin_pitch * (along_y u psi t v / n) - uphill_y cos_pitch sin_roll * (along_x u psi t v / n))
    <= sin_tilt * (perp / n)).
  { intros v perp H.
    replace (uphill_x sin_pitch * (along_y u psi t v / n) - uphill_y cos_pitch sin_roll * (along_x u psi t v / n))
      with ((uphill_x sin_pitch * along_y u psi t v - uphill_y cos_pitch sin_roll * along_x u psi t v) * / n)
      by (field; lra).
    rewrite across_in_body, Rabs_mult, (Rabs_pos_eq (/ n)) by lra.
    replace (sin_tilt * (perp / n)) with (sin_tilt * perp * / n) by (field; lra).
    apply Rmult_le_compat_r; [lra | exact H]. }
  assert (Hlength : plane_length (x omega) (y omega) = p / n).
  { unfold p. rewrite <- Hover, E1, E2. unfold plane_length. f_equal. field. lra. }
  pose proof tilt_on_circle as C1. pose proof (ExactRates.pitch_on_circle u psi t upwards) as C2.
  pose proof (roll_on_circle u psi t upwards) as C3. pose proof tilt_of_turns as C4.
  assert (C5 : 0 < cos_tilt /\ 0 <= sin_tilt /\ 0 < cos_roll).
  { split; [apply magnitude_of_tilt | split; [apply plane_length_nonneg | now apply cos_roll_positive]]. }
  assert (Hmixed : Rabs (uphill_y cos_pitch sin_roll * y omega) <= sin_tilt * mixed).
  { unfold mixed, p. rewrite <- Hover, E1.
    exact (mixed_bound cos_tilt sin_tilt cos_pitch sin_pitch cos_roll sin_roll C1 C2 C3 C5 C4 _ _ _ (Hacross _ _ H1)). }
  assert (Hz : z omega = omega_3 cos_pitch cos_roll sin_roll (y omega) (psi_1 t)) by exact E6.
  assert (Halong : Rabs (radial / n) = r / n).
  { unfold Rdiv. now rewrite Rabs_mult, (Rabs_pos_eq (/ n)) by lra. }
  assert (Hr0 : 0 <= r / n) by (rewrite <- Halong; apply Rabs_pos).
  rewrite <- Hlength. split.
  - unfold square, dot. rewrite Hz.
    exact (sharp_rate_bound cos_tilt sin_tilt cos_pitch sin_pitch cos_roll sin_roll C2 C5 C4
      (x omega) (y omega) (psi_1 t) mixed Hmixed).
  - pose proof (sharp_bound cos_tilt sin_tilt cos_pitch sin_pitch cos_roll sin_roll C1 C2 C3 C5 C4
      (x omega) (y omega) (psi_1 t) psi_2 (r / n) mixed Hmixed (radial / n)
      (along_x u psi t u_2 / n) (along_y u psi t u_2 / n) (perp_2 / n) Halong (Hacross _ _ H2)) as S.
    cbv zeta in S. rewrite Hover in S. fold w in S. eapply Rle_trans; [|exact S].
    right. unfold square, dot. rewrite E3, E4, E5, Hz.
    assert (Hc : cos_roll <> 0) by lra.
    unfold yawing. f_equal; [f_equal|]; (match goal with |- ?a * ?a = ?b * ?b => replace a with b; [ring|] end);
      unfold omega_3; field; lra.
Qed.

End Motion.
