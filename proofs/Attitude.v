(** * The attitude law: the tilt alone

    Section 6 of docs/extended-law.md, in exact arithmetic and continuous time;
    controller-core/src/extended/attitude.rs. b is the thrust axis, rho the
    desired one, theta the angle between them. Axes of the body, where b = e3. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Envelope.
Open Scope R_scope.

(** ** Angles, and the axis about which the vehicle has turned

    [v] is rho in the body's axes, or near half a turn the side m that is held
    there: b . rho = cos theta, b . m = sin theta_s. *)

(** The cosine of theta / 2, and vartheta = e tan (theta / 4). *)
Definition half (cosine : R) : R := sqrt ((1 + cosine) / 2).
Definition mrp (v_1 v_2 cosine : R) : space :=
  scaled (/ (2 * half cosine * (1 + half cosine))) {| x := v_2; y := - v_1; z := 0 |}.
(** The same of theta_s. *)
Definition held_half (sine : R) : R := sine / sqrt (2 * (1 + sqrt (1 - sine * sine))).
Definition held_mrp (v_1 v_2 sine : R) : space :=
  scaled (sqrt (1 - held_half sine * held_half sine) / (1 + held_half sine) / sqrt (1 - sine * sine))
    {| x := v_2; y := - v_1; z := 0 |}.

(** e: of length one across b. [u] is the cosine or the sine. *)
Definition axis (v_1 v_2 u : R) : space := scaled (/ sqrt (1 - u * u)) {| x := v_2; y := - v_1; z := 0 |}.

Lemma beside_one : forall u, -1 < u < 1 -> 0 < 1 - u * u.
Proof. intros u H. apply Rlt_le_trans with ((1 - u) * (1 + u)); [apply Rmult_lt_0_compat; lra | lra]. Qed.

Lemma axis_length : forall v_1 v_2 u, v_1 * v_1 + v_2 * v_2 + u * u = 1 -> -1 < u < 1 -> square (axis v_1 v_2 u) = 1.
Proof.
  intros v_1 v_2 u H Hu. pose proof (beside_one u Hu). assert (0 < sqrt (1 - u * u)) by now apply sqrt_lt_R0.
  unfold axis, square, dot, scaled. cbn.
  transitivity ((v_1 * v_1 + v_2 * v_2) / (sqrt (1 - u * u) * sqrt (1 - u * u))); [field; lra|].
  rewrite sqrt_def by lra. replace (v_1 * v_1 + v_2 * v_2) with (1 - u * u) by lra. field. lra.
Qed.

Lemma tan_quarter : forall angle h, 0 <= angle < 2 * PI -> cos (angle / 2) = h ->
  tan (angle / 4) = sqrt (1 - h * h) / (1 + h) /\ 0 < 1 + h /\ sqrt (1 - h * h) = sin (angle / 2).
Proof.
  intros angle h Ha <-. pose proof PI_RGT_0.
  assert (E1 : 1 + cos (angle / 2) = 2 * (cos (angle / 4) * cos (angle / 4)))
    by (replace (angle / 2) with (2 * (angle / 4)) by field; rewrite cos_2a_cos; ring).
  assert (Hc : 0 < cos (angle / 4)) by (apply cos_gt_0; lra). pose proof (Rmult_lt_0_compat _ _ Hc Hc).
  assert (Hs : 0 <= sin (angle / 2)) by (apply sin_ge_0; lra).
  assert (E : sqrt (1 - cos (angle / 2) * cos (angle / 2)) = sin (angle / 2)).
  { pose proof (sin2_cos2 (angle / 2)) as Hp. unfold Rsqr in Hp.
    replace (1 - cos (angle / 2) * cos (angle / 2)) with (sin (angle / 2) * sin (angle / 2)) by lra.
    now apply sqrt_square. }
  split; [|lra]. rewrite E, E1. unfold tan. replace (angle / 2) with (2 * (angle / 4)) by field. rewrite sin_2a.
  field. lra.
Qed.

(** vartheta is tan (theta / 4) along e. *)
Theorem mrp_of_the_angle : forall v_1 v_2 cosine, -1 < cosine < 1 ->
  mrp v_1 v_2 cosine = scaled (tan (acos cosine / 4)) (axis v_1 v_2 cosine).
Proof.
  intros v_1 v_2 c Hc. pose proof (acos_bound_lt c Hc). pose proof PI_RGT_0.
  assert (Hhalf : 0 < cos (acos c / 2)) by (apply cos_gt_0; lra).
  assert (E : cos (acos c / 2) * cos (acos c / 2) = (1 + c) / 2).
  { rewrite <- (cos_acos c) at 3 by lra. replace (acos c) with (2 * (acos c / 2)) at 3 by field.
    rewrite cos_2a_cos. field. }
  assert (Ehalf : cos (acos c / 2) = half c) by (unfold half; rewrite <- E; symmetry; apply sqrt_square; lra).
  destruct (tan_quarter (acos c) (half c) ltac:(lra) Ehalf) as (Et & Hp & Es). rewrite Et, Es.
  assert (Esin : sqrt (1 - c * c) = 2 * sin (acos c / 2) * half c).
  { rewrite <- Ehalf, <- sin_2a. replace (2 * (acos c / 2)) with (acos c) by field. now rewrite sin_acos by lra. }
  assert (0 < sin (acos c / 2)) by (apply sin_gt_0; lra). rewrite Ehalf in Hhalf.
  unfold mrp, axis, scaled. cbn. rewrite Esin. f_equal; field; lra.
Qed.

Theorem held_mrp_of_the_angle : forall v_1 v_2 sine, -1 < sine < 1 ->
  held_mrp v_1 v_2 sine = scaled (tan ((PI - asin sine) / 4)) (axis v_1 v_2 sine)
  /\ cos ((PI - asin sine) / 2) = held_half sine.
Proof.
  intros v_1 v_2 s Hs. pose proof PI_RGT_0. pose proof (asin_bound_lt s Hs).
  assert (Hc : 0 < cos (asin s / 2)) by (apply cos_gt_0; lra).
  assert (E : cos ((PI - asin s) / 2) = held_half s).
  { replace ((PI - asin s) / 2) with (PI / 2 - asin s / 2) by field. rewrite cos_shift. unfold held_half.
    replace (sqrt (1 - s * s)) with (cos (asin s)) by (rewrite cos_asin by lra; reflexivity).
    replace (asin s) with (2 * (asin s / 2)) at 2 by field. rewrite cos_2a_cos.
    replace (2 * (1 + (2 * cos (asin s / 2) * cos (asin s / 2) - 1)))
      with (2 * cos (asin s / 2) * (2 * cos (asin s / 2))) by ring.
    rewrite sqrt_square by lra. rewrite <- (sin_asin s) at 2 by lra.
    replace (asin s) with (2 * (asin s / 2)) at 2 by field. rewrite sin_2a. field. lra. }
  split; [|exact E]. destruct (tan_quarter (PI - asin s) _ ltac:(lra) E) as (Et & _). rewrite Et.
  unfold held_mrp, axis, scaled. cbn. f_equal; unfold Rdiv; ring.
Qed.

(** How b . v moves, for a v that turns with omega_rho, as rho and m do: c_1 and
    c_2 are the body's other axes. Only rates about these count. *)
Theorem tilt_moves : forall (b v : R -> space) (c_1 c_2 omega omega_rho : space) t,
  b t = cross c_1 c_2 -> moves b t (cross omega (b t)) -> moves v t (cross omega_rho (v t)) ->
  let e := sub omega omega_rho in
  is_derive (fun s => dot (b s) (v s)) t (dot e c_2 * dot c_1 (v t) - dot e c_1 * dot c_2 (v t)).
Proof.
  intros b v c_1 c_2 omega omega_rho t Hb Mb Mv e.
  eapply derive_as; [exact (moves_dot _ _ _ _ _ Mb Mv)|]. rewrite Hb. unfold e. components. ring.
Qed.

(** So the angles grow by omega~ . e. *)
Theorem angle_moves : forall (v_3 : R -> R) (t v_1 v_2 e_1 e_2 : R), -1 < v_3 t < 1 ->
  is_derive v_3 t (e_2 * v_1 - e_1 * v_2) -> let rate := dot {| x := e_1; y := e_2; z := 0 |} (axis v_1 v_2 (v_3 t)) in
  is_derive (fun s => acos (v_3 s)) t rate /\ is_derive (fun s => PI - asin (v_3 s)) t rate.
Proof.
  intros v_3 t v_1 v_2 e_1 e_2 Hu H rate. set (u := v_3 t) in *.
  assert (0 < sqrt (1 - u * u)) by now apply sqrt_lt_R0, beside_one. split.
  - evar_last; [apply (is_derive_comp acos v_3); [|exact H]|].
    + apply is_derive_Reals, derive_pt_eq_1 with (pr := derivable_pt_acos _ Hu), derive_pt_acos.
    + unfold rate, scal, axis, scaled, dot, Rsqr. cbn. unfold mult. cbn. fold u. field. lra.
  - evar_last; [apply @is_derive_minus; [apply @is_derive_const|]; apply (is_derive_comp asin v_3); [|exact H]|].
    + apply is_derive_Reals, derive_pt_eq_1 with (pr := derivable_pt_asin _ Hu), derive_pt_asin.
    + unfold rate, scal, minus, plus, opp, zero, axis, scaled, dot, Rsqr. cbn. unfold mult. cbn. fold u. field. lra.
Qed.

(** ** The pull of the error *)

Section Pull.

(** k_theta and M. *)
Variables (k M : R).
Hypothesis k_positive : 0 < k.
Hypothesis M_positive : 0 < M.

(** P, as the code has it, and its size as a function of the angle. *)
Definition pull (vartheta : space) : space :=
  scaled (M / sqrt (M * M + square (scaled k vartheta))) (scaled k vartheta).
Definition strength (theta : R) : R :=
  k * tan (theta / 4) * M / sqrt (M * M + k * tan (theta / 4) * (k * tan (theta / 4))).

Lemma M_squared : 0 < M * M.
Proof. now apply Rmult_lt_0_compat. Qed.

Theorem pull_of_the_angle : forall theta e, square e = 1 ->
  pull (scaled (tan (theta / 4)) e) = scaled (strength theta) e.
Proof.
  intros theta e He. unfold pull, strength. set (t := tan (theta / 4)).
  replace (square (scaled k (scaled t e))) with (k * t * (k * t) * square e)
    by (components; ring).
  rewrite He, Rmult_1_r. unfold scaled. cbn. f_equal; unfold Rdiv; ring.
Qed.

(** It never reaches its level. *)
Theorem pull_below_level : forall v, length (pull v) < M.
Proof.
  intros v. unfold pull. set (w := scaled k v). pose proof (square_nonneg w). pose proof M_squared.
  assert (Hroot : 0 < sqrt (M * M + square w)) by (apply sqrt_lt_R0; lra).
  rewrite length_scaled, Rabs_pos_eq by (apply Rmult_le_pos; [lra | left; now apply Rinv_0_lt_compat]).
  assert (Hless : length w < sqrt (M * M + square w)) by (apply sqrt_lt_1_alt; lra).
  apply Rmult_lt_reg_r with (sqrt (M * M + square w)); [exact Hroot|].
  replace (M / sqrt (M * M + square w) * length w * sqrt (M * M + square w)) with (M * length w) by (field; lra).
  now apply Rmult_lt_compat_l.
Qed.

(** Without a pull there is no error: the target is the only equilibrium. *)
Theorem only_the_target : forall theta, 0 <= theta < 2 * PI -> strength theta = 0 -> theta = 0.
Proof.
  intros theta H E. destruct (proj1 H) as [Hpos|<-]; [exfalso | reflexivity].
  assert (Ht : 0 < tan (theta / 4)) by (apply tan_gt_0; lra). revert E. apply Rgt_not_eq.
  apply Rdiv_lt_0_compat; [apply Rmult_lt_0_compat; [apply Rmult_lt_0_compat|]; assumption|].
  apply sqrt_lt_R0. pose proof M_squared. pose proof (squared (k * tan (theta / 4))). lra.
Qed.

Lemma tan_rises : forall a c, 0 <= a <= c -> c < 2 * PI -> 0 <= tan (a / 4) <= tan (c / 4).
Proof.
  intros a c H Hc. pose proof PI_RGT_0. split.
  - destruct (proj1 H) as [Ha|<-]; [left; apply tan_gt_0; lra|]. unfold Rdiv. rewrite Rmult_0_l, tan_0. lra.
  - destruct (proj2 H) as [Hac|<-]; [left; apply tan_increasing; lra | lra].
Qed.

Lemma strength_nonneg : forall theta, 0 <= theta < 2 * PI -> 0 <= strength theta.
Proof.
  intros theta H. destruct (tan_rises theta theta) as [Htan _]; [lra | lra |]. unfold strength.
  apply Rmult_le_pos; [apply Rmult_le_pos; [apply Rmult_le_pos|]; lra|]. left. apply Rinv_0_lt_compat, sqrt_lt_R0.
  pose proof M_squared. pose proof (squared (k * tan (theta / 4))). lra.
Qed.

(** The pull rises with the angle. *)
Lemma saturation_rises : forall u v, 0 <= u <= v -> u * M / sqrt (M * M + u * u) <= v * M / sqrt (M * M + v * v).
Proof.
  intros u v Huv. pose proof M_squared. pose proof (squared u). pose proof (squared v).
  assert (Hr : forall w, 0 < sqrt (M * M + w * w)) by (intros w; apply sqrt_lt_R0; pose proof (squared w); lra).
  pose proof (Hr u). pose proof (Hr v).
  assert (Hcross : u * sqrt (M * M + v * v) <= v * sqrt (M * M + u * u)).
  { assert (Hin : forall p c, 0 <= p -> p * sqrt c = sqrt (p * p * c))
      by (intros; rewrite sqrt_mult_alt by apply squared; now rewrite sqrt_square).
    rewrite !Hin by lra. apply sqrt_le_1_alt. assert (u * u <= v * v) by (apply Rmult_le_compat; lra). nra. }
  apply Rmult_le_reg_r with (sqrt (M * M + u * u) * sqrt (M * M + v * v)); [now apply Rmult_lt_0_compat|].
  apply Rmult_le_compat_l with (r := M) in Hcross; [|lra]. unfold Rdiv. field_simplify; lra.
Qed.

Lemma strength_rises : forall a c, 0 <= a <= c -> c < 2 * PI -> strength a <= strength c.
Proof.
  intros a c H Hc. destruct (tan_rises a c H Hc) as [Ha Ht]. apply saturation_rises. split.
  - apply Rmult_le_pos; lra.
  - apply Rmult_le_compat_l; lra.
Qed.

(** The potential: any function of the angle with the slope |P|. *)
Variable potential : R -> R.
Hypothesis potential_slope : forall theta, 0 <= theta < 2 * PI -> is_derive potential theta (strength theta).

Lemma potential_rises : forall a c, 0 <= a <= c -> c < 2 * PI -> potential a <= potential c.
Proof.
  intros a c H Hc. apply (does_not_fall potential strength a c (proj2 H)).
  - intros s Hs. apply potential_slope. lra.
  - intros s Hs. apply strength_nonneg. lra.
Qed.

Lemma asin_nonneg : forall a, 0 <= a <= 1 -> 0 <= asin a.
Proof.
  intros a Ha. apply Rnot_lt_le. intros Hn. pose proof (asin_bound a). pose proof PI_RGT_0.
  assert (Hs : sin (asin a) < sin 0) by (apply sin_increasing_1; lra).
  rewrite sin_asin, sin_0 in Hs; lra.
Qed.

Lemma below_one : forall a, a * a <= 1 -> Rabs a <= 1.
Proof. intros a H. apply below_by_squares; [lra|]. rewrite <- Rabs_mult, Rabs_pos_eq by apply squared. lra. Qed.

(** b . m is at most sin theta in size: m is across rho. *)
Theorem side_within_sine : forall b rho m : space, square b = 1 -> square rho = 1 -> square m = 1 -> dot rho m = 0 ->
  dot b rho * dot b rho + dot b m * dot b m <= 1.
Proof.
  intros b rho m Hb Hr Hm Ho.
  pose proof (square_nonneg (sub b (add (scaled (dot b rho) rho) (scaled (dot b m) m)))) as H.
  replace (square (sub b (add (scaled (dot b rho) rho) (scaled (dot b m) m))))
    with (square b - 2 * (dot b rho * dot b rho + dot b m * dot b m)
      + dot b rho * dot b rho * square rho + dot b m * dot b m * square m
      + 2 * (dot b rho * dot b m) * dot rho m) in H by (components; ring).
  rewrite Hb, Hr, Hm, Ho in H. lra.
Qed.

(** So theta_s is never below theta, and what is left beyond half a turn is never
    above the other way round. *)
Theorem angle_below : forall cosine sine, cosine * cosine + sine * sine <= 1 ->
  acos cosine <= PI - asin (Rabs sine).
Proof.
  intros c s H. pose proof (squared c). pose proof (squared s). pose proof PI_RGT_0. pose proof (acos_bound c).
  assert (Ha : 0 <= Rabs s <= 1) by (split; [apply Rabs_pos | apply below_one; lra]).
  assert (Hc : -1 <= c <= 1) by (apply Rabs_le_between, below_one; lra).
  pose proof (asin_nonneg _ Ha). pose proof (asin_bound (Rabs s)). apply Rnot_lt_le. intros Hlt.
  (* The cosine falls. *)
  assert (Hcos : cos (acos c) < cos (PI - asin (Rabs s))) by (apply cos_decreasing_1; lra).
  rewrite cos_acos, Rtrigo_facts.cos_pi_minus, cos_asin, <- Rsqr_abs in Hcos by lra. unfold Rsqr in Hcos.
  pose proof (sqrt_def (1 - s * s) ltac:(lra)). pose proof (sqrt_pos (1 - s * s)). nra.
Qed.

(** Leaving the region where m is held does not raise the potential. *)
Theorem leaving_falls : forall cosine sine, cosine * cosine + sine * sine <= 1 ->
  potential (acos cosine) <= potential (PI - asin sine).
Proof.
  intros c s H. pose proof (angle_below c s H) as Hb. pose proof PI_RGT_0. pose proof (acos_bound c).
  pose proof (squared c). assert (Hs : -1 <= s <= 1) by (apply Rabs_le_between, below_one; lra).
  pose proof (asin_bound s).
  apply potential_rises; [split; [lra|] | lra].
  eapply Rle_trans; [exact Hb|]. unfold Rabs. destruct (Rcase_abs s); [|lra].
  pose proof (asin_nonneg (- s) ltac:(lra)). rewrite asin_opp in *. lra.
Qed.

(** At theta_s = pi + 2 a, with sin a = q_bar, the switch takes the other way
    round: the potential falls by at least 4 a times the pull there. *)
Theorem switch_falls : forall a theta, 0 <= a < PI / 2 -> 0 <= theta <= PI - 2 * a ->
  potential theta <= potential (PI + 2 * a) - 4 * a * strength (PI - 2 * a).
Proof.
  intros a theta Ha Htheta. pose proof PI_RGT_0.
  apply Rle_trans with (potential (PI - 2 * a)); [apply potential_rises; lra|].
  pose proof (does_not_fall (fun r => potential r - strength (PI - 2 * a) * r)
    (fun r => strength r - strength (PI - 2 * a)) (PI - 2 * a) (PI + 2 * a) ltac:(lra)) as Hfall.
  enough (potential (PI - 2 * a) - strength (PI - 2 * a) * (PI - 2 * a)
    <= potential (PI + 2 * a) - strength (PI - 2 * a) * (PI + 2 * a)) by lra.
  apply Hfall; intros s Hs.
  - apply @is_derive_minus; [apply potential_slope; lra|]. auto_derive; [exact I | ring].
  - assert (strength (PI - 2 * a) <= strength s) by (apply strength_rises; lra). lra.
Qed.

End Pull.

(** ** V falls, whatever the vehicle does about its thrust axis *)

(** g, and what does no work. *)
Definition gyroscopic (j_1 j_2 j_3 o_3 r_1 r_2 r_3 e_1 e_2 : R) : space :=
  {| x := r_2 * ((j_3 + j_1 - j_2) * o_3 - j_1 * r_3) + / 2 * (j_1 - j_2) * (o_3 - r_3) * e_2;
     y := - r_1 * ((j_3 + j_2 - j_1) * o_3 - j_2 * r_3) + / 2 * (j_1 - j_2) * (o_3 - r_3) * e_1;
     z := 0 |}.
Definition kappa (j_1 j_2 j_3 o_3 r_3 : R) : R := / 2 * (j_1 + j_2) * (o_3 + r_3) - j_3 * o_3.

(** h: at right angles to omega~. *)
Definition precession (j_3 o_3 : R) (e : space) : space := scaled (j_3 * o_3) {| x := y e; y := - x e; z := 0 |}.

(** D: [sine] is that of theta / 2. *)
Definition damping (k_omega r_0 sine : R) (e : space) : space :=
  scaled (k_omega / sqrt (sqrt (1 + sine / r_0 * (sine / r_0)))) e.

Section Descent.

(** A motion: the body's rates, r = R^T omega_rho, and the angle, theta or
    theta_s, about the axis e. *)
Variables (j_1 j_2 j_3 : R) (o_1 o_2 o_3 r_1 r_2 r_3 angle : R -> R) (t : R) (e : space).
Hypothesis inertia_positive : 0 < j_1 /\ 0 < j_2.
Definition e_1 (s : R) : R := o_1 s - r_1 s.
Definition e_2 (s : R) : R := o_2 s - r_2 s.

(** R^T omega_rho', the shares of damping and of h, the bias, and what the torque lacks: of g
    where it does not fit, of the bias where its estimate is wrong. *)
Variables (a_1 a_2 k M lambda nu : R) (D bias lack : space).
Definition P : space := scaled (strength k M (angle t)) e.
Definition g : space := gyroscopic j_1 j_2 j_3 (o_3 t) (r_1 t) (r_2 t) (r_3 t) (e_1 t) (e_2 t).
Definition h : space := precession j_3 (o_3 t) {| x := e_1 t; y := e_2 t; z := 0 |}.
Definition tau_1 : R := j_1 * a_1 + x g - x P - lambda * x D + nu * x h - x bias - x lack.
Definition tau_2 : R := j_2 * a_2 + y g - y P - lambda * y D + nu * y h - y bias - y lack.

(** Euler's equations about the tilt's axes, with the bias; r' = R^T omega_rho' -
    omega x r; [angle_moves]. *)
Hypothesis euler_1 : is_derive o_1 t ((tau_1 + x bias - (j_3 - j_2) * o_2 t * o_3 t) / j_1).
Hypothesis euler_2 : is_derive o_2 t ((tau_2 + y bias - (j_1 - j_3) * o_3 t * o_1 t) / j_2).
Hypothesis frame_1 : is_derive r_1 t (a_1 - (o_2 t * r_3 t - o_3 t * r_2 t)).
Hypothesis frame_2 : is_derive r_2 t (a_2 - (o_3 t * r_1 t - o_1 t * r_3 t)).
Hypothesis motion : is_derive angle t (e_1 t * x e + e_2 t * y e).
Variable potential : R -> R.
Hypothesis potential_slope : is_derive potential (angle t) (strength k M (angle t)).

Definition V (s : R) : R := (j_1 * (e_1 s * e_1 s) + j_2 * (e_2 s * e_2 s)) / 2 + potential (angle s).

(** J omega~': the terms with kappa and h do no work. *)
Theorem error_rates : let carried := kappa j_1 j_2 j_3 (o_3 t) (r_3 t) + nu * (j_3 * o_3 t) in
  is_derive e_1 t ((- x P - lambda * x D - x lack + carried * e_2 t) / j_1)
  /\ is_derive e_2 t ((- y P - lambda * y D - y lack - carried * e_1 t) / j_2).
Proof.
  intros carried. split.
  - evar_last; [apply @is_derive_minus; [exact euler_1 | exact frame_1]|].
    unfold minus, plus, opp, carried, kappa, tau_1, h, precession, scaled, g, gyroscopic, e_1, e_2. cbn. field. lra.
  - evar_last; [apply @is_derive_minus; [exact euler_2 | exact frame_2]|].
    unfold minus, plus, opp, carried, kappa, tau_2, h, precession, scaled, g, gyroscopic, e_1, e_2. cbn. field. lra.
Qed.

(** V' = - lambda omega~ . D, less what is lacking: whatever J, reference and spin
    are. *)
Theorem descent : is_derive V t
  (- (lambda * (e_1 t * x D + e_2 t * y D)) - (e_1 t * x lack + e_2 t * y lack)).
Proof.
  destruct error_rates as [H1 H2]. unfold V.
  evar_last.
  - apply @is_derive_plus; [|apply (is_derive_comp potential angle); [exact potential_slope | exact motion]].
    apply (is_derive_ext (fun s => / 2 * (j_1 * (e_1 s * e_1 s) + j_2 * (e_2 s * e_2 s)))); [intros; apply Rmult_comm|].
    apply is_derive_scal. apply @is_derive_plus; apply is_derive_scal.
    + apply is_derive_Reals. apply is_derive_Reals in H1. exact (derivable_pt_lim_mult _ _ _ _ _ H1 H1).
    + apply is_derive_Reals. apply is_derive_Reals in H2. exact (derivable_pt_lim_mult _ _ _ _ _ H2 H2).
  - unfold plus, scal. cbn. unfold mult. cbn. unfold P, scaled. cbn. field. lra.
Qed.

(** So where nothing lacks V falls, unless omega~ is zero about the tilt's axes. *)
Theorem v_falls : forall k_omega r_0 sine, 0 < lambda -> 0 < k_omega ->
  D = damping k_omega r_0 sine {| x := e_1 t; y := e_2 t; z := 0 |} -> lack = {| x := 0; y := 0; z := 0 |} ->
  (e_1 t <> 0 \/ e_2 t <> 0) ->
  - (lambda * (e_1 t * x D + e_2 t * y D)) - (e_1 t * x lack + e_2 t * y lack) < 0.
Proof.
  intros k_omega r_0 sine Hl Hk -> -> Hmoves. unfold damping, scaled. cbn [x y].
  assert (Hroot : 0 < sqrt (sqrt (1 + sine / r_0 * (sine / r_0))))
    by (apply sqrt_lt_R0, sqrt_lt_R0; pose proof (squared (sine / r_0)); lra).
  set (c := k_omega / _). assert (Hc : 0 < c) by now apply Rdiv_lt_0_compat.
  assert (Hsum : 0 < e_1 t * e_1 t + e_2 t * e_2 t).
  { pose proof (squared (e_1 t)). pose proof (squared (e_2 t)).
    destruct Hmoves as [Hm|Hm]; pose proof (Rsqr_pos_lt _ Hm) as Hs; unfold Rsqr in Hs; lra. }
  pose proof (Rmult_lt_0_compat _ _ (Rmult_lt_0_compat _ _ Hl Hc) Hsum). lra.
Qed.

End Descent.
