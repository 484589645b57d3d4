(** * The heading: yaw takes what is left

    Section 5 of docs/extended-law.md, in exact arithmetic and continuous time;
    controller-core/src/extended/heading.rs. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

(** ** The speed at which an error comes to zero *)

Section Speed.

(** k = c_1 / c_2, A, W_max. *)
Variables (k A W : R).
Hypothesis k_positive : 0 < k.
Hypothesis A_positive : 0 < A.
Hypothesis W_positive : 0 < W.

Definition slowed (psi : R) : R := 1 + Rabs psi * (k * k / (2 * A)) + k * psi / W * (k * psi / W).
Definition speed (psi : R) : R := k * psi / sqrt (slowed psi).

Lemma slowed_parts : 0 < k * k / (2 * A) /\ 0 < k * k / (W * W).
Proof. split; apply Rdiv_lt_0_compat; try apply Rmult_lt_0_compat; lra. Qed.

Lemma slowed_positive : forall psi, 1 <= slowed psi.
Proof.
  intros psi. unfold slowed. pose proof (Rabs_pos psi). pose proof (Rle_0_sqr (k * psi / W)) as Hs. unfold Rsqr in Hs.
  destruct slowed_parts. pose proof (Rmult_le_pos (Rabs psi) (k * k / (2 * A))). lra.
Qed.

Lemma speed_squared : forall psi, speed psi * speed psi = k * psi * (k * psi) / slowed psi.
Proof.
  intros psi. pose proof (slowed_positive psi). unfold speed. rewrite <- (sqrt_def (slowed psi)) at 3 by lra.
  field. apply Rgt_not_eq, sqrt_lt_R0. lra.
Qed.

(** At most W_max. *)
Theorem speed_below : forall psi, speed psi * speed psi <= W * W.
Proof.
  intros psi. rewrite speed_squared. pose proof (slowed_positive psi).
  apply Rmult_le_reg_r with (slowed psi); [lra|].
  replace (k * psi * (k * psi) / slowed psi * slowed psi) with (k * psi * (k * psi)) by (field; lra).
  replace (W * W * slowed psi) with (W * W * (1 + Rabs psi * (k * k / (2 * A))) + k * psi * (k * psi))
    by (unfold slowed; field; lra).
  destruct slowed_parts. pose proof (Rmult_le_pos _ (k * k / (2 * A)) (Rabs_pos psi)).
  pose proof (Rmult_le_pos (W * W) (1 + Rabs psi * (k * k / (2 * A)))). pose proof (Rmult_le_pos W W). lra.
Qed.

(** And such that A brakes it: along psi' = - v the speed changes by v v', half
    the slope of v^2, which is below A. *)
Theorem speed_is_braked : forall psi, 0 < psi ->
  exists slope, is_derive (fun p => speed p * speed p) psi slope /\ slope / 2 < A.
Proof.
  intros psi Hpsi. destruct slowed_parts as [Ha Hc]. set (a := k * k / (2 * A)) in *. set (c := k * k / (W * W)) in *.
  pose proof (Rmult_lt_0_compat _ _ Hpsi Ha) as Hu.
  pose proof (Rmult_lt_0_compat _ _ (Rmult_lt_0_compat _ _ Hpsi Hpsi) Hc) as Hw. set (n := 1 + psi * a + psi * psi * c).
  exists (k * k * (2 * psi + a * (psi * psi)) / (n * n)). split.
  - apply (is_derive_ext_loc (fun p => k * k * (p * p) / (1 + p * a + p * p * c))).
    + exists (mkposreal psi Hpsi). intros p Hp. assert (Hp0 : 0 < p) by (apply Rabs_def2 in Hp; cbn in Hp; lra).
      rewrite speed_squared. unfold slowed. rewrite Rabs_pos_eq by lra. unfold a, c.
      f_equal; [ring|]. f_equal. field. lra.
    + unfold n. auto_derive; [lra | field; lra].
  - assert (Hn : 0 < n) by (unfold n; lra). pose proof (Rmult_lt_0_compat _ _ Hn Hn).
    apply Rmult_lt_reg_r with (2 * (n * n)); [lra|].
    replace (k * k * (2 * psi + a * (psi * psi)) / (n * n) / 2 * (2 * (n * n)))
      with (2 * A * (2 * (psi * a) + psi * a * (psi * a))) by (unfold a; field; lra).
    replace (A * (2 * (n * n))) with (2 * A * (n * n)) by ring. apply Rmult_lt_compat_l; [lra|]. unfold n. nra.
Qed.

End Speed.

(** ** What yaw gets *)

Definition cut (low high wanted : R) : R := Rmin high (Rmax low wanted).

Lemma cut_rises : forall low high a c, a <= c -> cut low high a <= cut low high c.
Proof.
  intros low high a c H. unfold cut. apply Rle_min_compat_l. now apply Rle_max_compat_l.
Qed.

(** psi_0: the identity cut to an interval about zero. [a_d] is the reference's
    acceleration, [others] what turns besides: the bias and (J_1 - J_2) omega_1
    omega_2. *)
Definition got (j_3 Y_1 Y_2 a_d others wanted : R) : R :=
  - cut ((- Y_1 + others) / j_3 - a_d) ((Y_2 + others) / j_3 - a_d) (- wanted).

(** The torque that yaw asks for, with [feedback] for c_2 (e + v), and what it
    makes of e. *)
Definition asked (j_3 a_d others feedback : R) : R := j_3 * (a_d - feedback) - others.

Theorem yaw_closed_loop : forall j_3 Y_1 Y_2 a_d others feedback, 0 < j_3 ->
  (cut (- Y_1) Y_2 (asked j_3 a_d others feedback) + others) / j_3 - a_d = - got j_3 Y_1 Y_2 a_d others feedback.
Proof.
  intros j_3 Y_1 Y_2 a_d others f Hj. unfold got, cut, asked. rewrite Ropp_involutive.
  assert (Hi : 0 <= / j_3) by (left; now apply Rinv_0_lt_compat).
  unfold Rdiv, Rminus. rewrite Rplus_min_distr_r, Rplus_max_distr_r, Rmult_min_distr_r, Rmult_max_distr_r,
    Rplus_min_distr_r, Rplus_max_distr_r by exact Hi.
  do 2 f_equal. field. lra.
Qed.

(** The reference's torque is within the ends: then psi_0 has its argument's
    sign. *)
Theorem got_has_the_sign : forall j_3 Y_1 Y_2 a_d others wanted, 0 < j_3 ->
  - Y_1 < j_3 * a_d - others < Y_2 -> wanted <> 0 -> 0 < wanted * got j_3 Y_1 Y_2 a_d others wanted.
Proof.
  intros j_3 Y_1 Y_2 a_d others w Hj [Hlow Hhigh] Hw. unfold got, cut.
  assert (Hl : (- Y_1 + others) / j_3 - a_d < 0).
  { apply Rmult_lt_reg_r with j_3; [exact Hj|]. unfold Rminus. rewrite Rmult_plus_distr_r. field_simplify; lra. }
  assert (Hh : 0 < (Y_2 + others) / j_3 - a_d).
  { apply Rmult_lt_reg_r with j_3; [exact Hj|]. unfold Rminus. rewrite Rmult_plus_distr_r. field_simplify; lra. }
  set (low := _ - a_d) in Hl |- *. set (high := (Y_2 + others) / j_3 - a_d) in *.
  unfold Rmin, Rmax. destruct (Rdichotomy _ _ Hw); repeat destruct (Rle_dec _ _); nra.
Qed.

(** How much of a spin a rate error is: nothing up to W, all of it from 2 W on. *)
Definition spin (W rate : R) : R := cut 0 1 (Rabs rate / W - 1).

Theorem no_spin : forall W rate, 0 < W -> Rabs rate <= W -> spin W rate = 0.
Proof.
  intros W rate HW H. assert (Rabs rate / W <= 1) by (apply Rcomplements.Rle_div_l; lra).
  unfold spin, cut, Rmax, Rmin. repeat destruct (Rle_dec _ _); lra.
Qed.

(** The part that comes before thrust: at most J_3 A for a spin, of what is
    wanted, against the rate. *)
Definition braking (j_3 A W torque rate : R) : R :=
  if Rlt_dec (torque * rate) 0
  then cut (- (spin W rate * (j_3 * A))) (spin W rate * (j_3 * A)) torque else 0.

Theorem braking_is_part : forall j_3 A W torque rate, 0 <= j_3 * A ->
  Rabs (braking j_3 A W torque rate) <= spin W rate * (j_3 * A) <= j_3 * A
  /\ Rmin torque 0 <= braking j_3 A W torque rate <= Rmax torque 0.
Proof.
  intros j_3 A W torque rate H. unfold braking. pose proof (Rmin_r torque 0). pose proof (Rmax_r torque 0).
  assert (Hs : 0 <= spin W rate <= 1) by (unfold spin, cut, Rmax, Rmin; repeat destruct (Rle_dec _ _); lra).
  assert (Hm : 0 <= spin W rate * (j_3 * A) <= j_3 * A) by nra.
  set (most := spin W rate * (j_3 * A)) in *. unfold cut.
  destruct (Rlt_dec _ _); [|rewrite Rabs_R0; lra].
  split; [split; [apply Rabs_le|lra]|]; unfold Rmax, Rmin; repeat destruct (Rle_dec _ _); lra.
Qed.

(** ** The heading arrives: its energy does not rise *)

Section Energy.

(** The error chi and e = omega_3 - w_3, for ends that stand still. *)
Variables (chi e : R -> R) (t c_2 j_3 Y_1 Y_2 a_d others : R) (v potential : R -> R).
Let psi_0 := got j_3 Y_1 Y_2 a_d others.
Hypothesis motion : is_derive chi t (e t).
Hypothesis closed_loop : is_derive e t (- psi_0 (c_2 * (e t + v (chi t)))).
Hypothesis potential_slope : is_derive potential (chi t) (psi_0 (c_2 * v (chi t))).

Definition energy (s : R) : R := e s * e s / 2 + potential (chi s).

Theorem energy_falls : 0 <= c_2 ->
  let rate := - (e t * (psi_0 (c_2 * (e t + v (chi t))) - psi_0 (c_2 * v (chi t)))) in
  is_derive energy t rate /\ rate <= 0.
Proof.
  intros Hc rate. split.
  - unfold energy. evar_last.
    + apply @is_derive_plus; [|apply (is_derive_comp potential chi); [exact potential_slope | exact motion]].
      apply (is_derive_ext (fun s => / 2 * (e s * e s))); [intros; apply Rmult_comm|]. apply is_derive_scal.
      apply is_derive_Reals. pose proof closed_loop as H. apply is_derive_Reals in H.
      exact (derivable_pt_lim_mult _ _ _ _ _ H H).
    + unfold rate, plus, scal. cbn. unfold mult. cbn. field.
  - unfold rate.
    assert (Hmono : forall a c, a <= c -> psi_0 a <= psi_0 c).
    { intros a c H. unfold psi_0, got. apply Ropp_le_contravar, cut_rises. lra. }
    set (u := c_2 * v (chi t)). replace (c_2 * (e t + v (chi t))) with (u + c_2 * e t) by (unfold u; ring).
    destruct (Rle_dec 0 (e t)) as [H|H].
    + pose proof (Hmono u (u + c_2 * e t) ltac:(pose proof (Rmult_le_pos _ _ Hc H); lra)) as Hless.
      assert (0 <= e t * (psi_0 (u + c_2 * e t) - psi_0 u)) by (apply Rmult_le_pos; lra). lra.
    + pose proof (Hmono (u + c_2 * e t) u ltac:(pose proof (Rmult_le_pos c_2 (- e t)); lra)) as Hless.
      assert (0 <= - e t * (psi_0 u - psi_0 (u + c_2 * e t))) by (apply Rmult_le_pos; lra). lra.
Qed.

End Energy.
